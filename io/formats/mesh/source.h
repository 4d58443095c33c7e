#pragma once

#include <memory>

#include "io/formats/mesh/mesh.h"
#include "io/formats/scan.h"

namespace lucarne::io::mesh {

/// More samples than this are refused.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 30;
/// The limit of the default spacing, which is a thousandth of the box's diagonal, or finer if the vertices
/// are denser.
inline constexpr uint64_t kMostDefaultSamples = 20'000'000;

/// Returns whether a scan's points are samples of a mesh, which take seconds to compute. The scan's notes
/// then state the mesh's size and the approximate number of samples.
bool is_sampled(const ScanInfo& info);

/// Kinds of loss in damaged mesh files, in addition to io::lost.
inline constexpr std::string_view kCutFaces = "faces that are not there: the file ends before them",
                                  kDamagedFaces = "faces that make no sense",
                                  kCutLine = "lines that are cut off, and all that may have followed",
                                  kDamagedLines = "lines that make no sense";

/// Returns the samples of a mesh. The mesh must be finished and have triangles. `info` describes the file:
/// path, format, bytes, time, unit; `notes.mesh` may say more. `state` is a hash of everything else that the
/// samples depend on: textures. Errors: a spacing that would give too many samples.
Result<std::unique_ptr<PointSource>> sampled(Mesh mesh, ScanInfo info, uint64_t state,
                                             const ReadOptions& options);

/// Returns the vertices of a mesh with their colours, without its surface.
Result<std::unique_ptr<PointSource>> vertices_only(Mesh mesh, ScanInfo info);

}  // namespace lucarne::io::mesh
