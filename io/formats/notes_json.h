#pragma once

#include <string>
#include <string_view>

#include "io/notes.h"

namespace lucarne::io {

/// Returns the JSON object that a cache keeps as the `details` of a scan (octree/FORMAT.md). Equal notes give
/// equal bytes. Bytes that are not UTF-8 become U+FFFD.
std::string notes_text(const FormatNotes& notes);

/// Returns the notes in such a text. Nothing in it is trusted: a missing entry or one of the wrong type
/// counts as absent, and a text that is no JSON object as empty. A damaged LAS header is marked as such:
/// FormatNotes::las_damage.
FormatNotes notes_of_text(std::string_view text);

}  // namespace lucarne::io
