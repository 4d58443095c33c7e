#pragma once

#include <filesystem>

#include "io/formats/mesh/mesh.h"
#include "io/formats/scan.h"

namespace lucarne::io {

/// Returns the triangles of an OBJ or PLY file, finished, in its own unit and frame; none if the file is of
/// another kind or has only vertices. The content tells the format, as for open_scan(). Memory: the whole
/// mesh (mesh/README.md). Errors: an unreadable, empty or contradictory file.
Result<mesh::Mesh> load_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace lucarne::io
