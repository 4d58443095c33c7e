#pragma once

#include "io/formats/mesh/mesh.h"
#include "io/formats/ply/header.h"
#include "io/formats/scan.h"

namespace lucarne::io::ply {

/// Returns whether the file has at least one face, as lists of vertex_indices (or vertex_index).
bool has_faces(const Header& header);

struct Faces {
    std::unique_ptr<PointSource> mesh;  ///< null if no face has an area: then only the vertices count
    Losses losses;                      ///< of faces only
};
/// Opens the mesh, sampled. Uses colours of faces or vertices, normals of vertices, and texture coordinates
/// of faces (texcoord, with texnumber) or of vertices (s t, u v, texture_u texture_v), with the pictures that
/// comments name ("TextureFile a.png"), as MeshLab writes them. `info` is that of the vertices. With
/// `options.salvage` reads the complete faces.
Result<Faces> open_mesh(const std::shared_ptr<const ByteSource>& file, const Header& header, ScanInfo info,
                        const ReadOptions& options);

/// Returns the triangles of the file, finished. `color_bits` is that of its vertices' colours (ScanInfo).
Result<mesh::Mesh> load_mesh(const std::shared_ptr<const ByteSource>& file, const Header& header,
                             uint32_t color_bits, bool salvage);

}  // namespace lucarne::io::ply
