#pragma once

#include <string>
#include <string_view>

#include "io/notes.h"

namespace lucarne::io {

/// The JSON object that a cache keeps as the `details` of a scan (octree/FORMAT.md). The same notes give the
/// same bytes. What is no UTF-8 becomes U+FFFD.
std::string notes_text(const FormatNotes& notes);

/// The notes in such a text, of which nothing is trusted: what is missing or of another type counts as not
/// noted, a text that is no JSON object as empty. A damaged LAS header is kept as such:
/// FormatNotes::las_damage.
FormatNotes notes_of_text(std::string_view text);

}  // namespace lucarne::io
