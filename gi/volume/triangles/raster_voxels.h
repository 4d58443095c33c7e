#pragma once

#include <cstdint>

#include "gi/device/gl/device.h"
#include "gi/volume/triangles/mesh_triangles.h"
#include "gi/volume/voxel_set.h"

namespace lucarne::gi::volume {

/// How triangles get into the slices of a volume (Gaitatzes 2012, chapters 6.4.1 and 6.4.2).
enum class Slicing : uint8_t {
    cut,      ///< the geometry shader cuts them into strips
    discard,  ///< they are drawn whole into each slice, and the fragment shader discards what is outside
};

struct RasterVoxelOptions {
    Slicing slicing = Slicing::cut;
    /// Vertices that the geometry shader emits for a triangle at most: 3 to kMostEmitted. What does not fit
    /// is missing, as in the thesis. 0: triangles of many slices are drawn several times, and nothing is
    /// missing.
    uint32_t vertices = 0;
    uint32_t bits = 32;  ///< of each component: 16 or 32
    bool albedo = true, normals = true;
};
/// More vertices with their attributes need more than OpenGL promises.
inline constexpr uint32_t kMostEmitted = 64;

/// Draws triangles into the voxels of their grid, in one sweep along each axis: each triangle is drawn in the
/// sweep in which it is largest, so that those of its voxels are occupied through whose middle it passes,
/// seen along that axis. Areas are those of whole fragments. Memory: a layered target of all cells, of 4
/// bytes and another 16 for albedos and for normals (half as much with 16 bits), and some 50 MB. Errors:
/// device memory and limits, a shader that fails.
Result<VoxelSet> rasterize_triangles(Device& device, const MeshTriangles& triangles,
                                     const RasterVoxelOptions& options = {});

}  // namespace lucarne::gi::volume
