#pragma once

#include "gi/scene/look.h"
#include "octree/export/export.h"

namespace lucarne::viewer {

/// Restricts an export to the points that `look` shows: those that its clip keeps and whose class is not
/// hidden. `schema` is the source's.
void export_what_is_seen(const gi::Look& look, const io::Schema& schema, octree::ExportOptions& options);

}  // namespace lucarne::viewer
