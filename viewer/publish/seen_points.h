#pragma once

#include "gi/scene/look.h"
#include "octree/export/export.h"

namespace lucarne::viewer {

/// Restricts an export to the points that `look` shows: those that its clip keeps and whose class is not
/// hidden. `schema` is the source's.
void export_what_is_seen(const gi::Look& look, const io::Schema& schema, octree::ExportOptions& options);

/// Writes what an exporter gives to a scan file whose name says the format (.copc.laz too). Calls `progress`
/// with numbers of points of the source that are done. Returns the number of points written. On failure, and
/// if the export is cancelled, there is no file, or the former one.
Result<uint64_t> write_points(const octree::Exporter& exporter, const std::filesystem::path& file,
                              bool overwrite, const std::function<void(uint64_t)>& progress);

}  // namespace lucarne::viewer
