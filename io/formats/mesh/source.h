#pragma once

#include <memory>

#include "io/formats/mesh/mesh.h"
#include "io/formats/scan.h"

namespace lucarne::io::mesh {

/// More samples are refused when they are asked for.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 30;
/// Nobody asked: a thousandth of the box's diagonal, or finer where the vertices stand denser, for no more
/// than this.
inline constexpr uint64_t kMostDefaultSamples = 20'000'000;

/// Whether a scan's points are samples of a mesh, which take seconds to make. Its notes tell the mesh's size
/// and about how many samples there are.
bool is_sampled(const ScanInfo& info);

/// What is lost of damaged files, beside what io::lost has.
inline constexpr std::string_view kCutFaces = "faces that are not there: the file ends before them",
                                  kDamagedFaces = "faces that make no sense",
                                  kCutLine = "lines that are cut off, and all that may have followed",
                                  kDamagedLines = "lines that make no sense";

/// What is known of the file: path, format, bytes, time, unit; `notes.mesh` may say more.
/// `state` is a hash of all else that the samples follow from: textures.
/// The mesh is finished and has triangles. Errors: a spacing that would give too many samples.
Result<std::unique_ptr<PointSource>> sampled(Mesh mesh, ScanInfo info, uint64_t state,
                                             const ReadOptions& options);

/// The vertices of a mesh, without its surface, with their colours.
Result<std::unique_ptr<PointSource>> vertices_only(Mesh mesh, ScanInfo info);

}  // namespace lucarne::io::mesh
