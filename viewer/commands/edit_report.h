#pragma once

#include <string>

#include "octree/edit/edit.h"

namespace lucarne::viewer {

/// Compacts the cache if an update left less than half of it in use, and reports that. If compacting fails,
/// only warns: the update itself has been done.
void compact_after_update(const octree::EditOptions& edit, octree::EditReport& report);

/// Writes what an update did as JSON (`--json`).
Result<void> write_edit_report(const std::string& path, bool overwrite, const octree::EditReport& report);

}  // namespace lucarne::viewer
