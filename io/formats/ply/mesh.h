#pragma once

#include "io/formats/ply/header.h"
#include "io/formats/scan.h"

namespace lucarne::io::ply {

/// Whether there are faces, as lists of vertex_indices (or vertex_index), and as many as one.
bool has_faces(const Header& header);

struct Faces {
    std::unique_ptr<PointSource> mesh;  ///< null where none has an area: then the vertices are what there is
    Losses losses;                      ///< faces only
};
/// The mesh, sampled. Colours of faces or vertices; texture coordinates of faces (texcoord, with texnumber)
/// or of vertices (s t, u v, texture_u texture_v), with the pictures that comments name ("TextureFile
/// a.png"), as MeshLab writes them; normals of vertices. `info` is that of the vertices.
/// With `options.salvage` the faces that are whole.
Result<Faces> open_mesh(const std::shared_ptr<const ByteSource>& file, const Header& header, ScanInfo info,
                        const ReadOptions& options);

}  // namespace lucarne::io::ply
