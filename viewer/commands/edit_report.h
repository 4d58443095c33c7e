#pragma once

#include <string>

#include "octree/edit/edit.h"

namespace lucarne::viewer {

/// What an update did, for `--json`.
/// Compacts a cache of which an update left less than half in use, and says so. Where it cannot, the update
/// is done all the same: that is a warning.
void compact_after_update(const octree::EditOptions& edit, octree::EditReport& report);

Result<void> write_edit_report(const std::string& path, bool overwrite, const octree::EditReport& report);

}  // namespace lucarne::viewer
