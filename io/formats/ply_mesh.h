#pragma once

#include "io/formats/ply_header.h"
#include "io/formats/scan.h"

namespace lucarne::io::ply {

/// Whether there are faces, as lists of vertex_indices (or vertex_index), and as many as one.
bool has_faces(const Header& header);

/// The mesh, sampled. Colours of faces or vertices; texture coordinates of faces (texcoord, with texnumber)
/// or of vertices (s t, u v, texture_u texture_v), with the pictures that comments name ("TextureFile
/// a.png"), as MeshLab writes them; normals of vertices. `vertices` is the file without
/// its faces: what is given back where none of them has an area.
Result<std::unique_ptr<PointSource>> open_mesh(const std::shared_ptr<const InputFile>& file,
                                               const Header& header, std::unique_ptr<PointSource> vertices,
                                               const ReadOptions& options);

}  // namespace lucarne::io::ply
