#pragma once

#include "gi/volume/triangles/mesh_triangles.h"
#include "gi/volume/voxel_set.h"

namespace lucarne::gi::volume {

/// Divides triangles among the voxels of their grid, on the host: every voxel that a triangle meets is
/// occupied, and gets exactly the area inside it, by clipping; so the areas of all voxels add up to the
/// mesh's. What lies in the border of two voxels belongs to the upper one. The result is the same whatever
/// the number of threads. Besides the voxels it takes some 100 MB of memory.
VoxelSet areas_of_triangles(const MeshTriangles& triangles);

}  // namespace lucarne::gi::volume
