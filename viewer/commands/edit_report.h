#pragma once

#include <string>

#include "octree/edit/edit.h"

namespace lucarne::viewer {

/// What an update did, for `--json`.
Result<void> write_edit_report(const std::string& path, bool overwrite, const octree::EditReport& report);

}  // namespace lucarne::viewer
