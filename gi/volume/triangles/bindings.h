// Bindings of the shaders that draw triangles into voxels, and the record they collect; for C++ and GLSL.
#ifndef LUCARNE_GI_VOLUME_TRIANGLES_BINDINGS_H
#define LUCARNE_GI_VOLUME_TRIANGLES_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::volume {
#endif

// Storage buffers.
const uint kBindFound = 0u;  // FoundVoxel[]
const uint kBindCount = 1u;  // how many there are

// Texture units.
const uint kUnitCorners = 0u;   // four words each: a place in units of voxels, and the albedo's code
const uint kUnitCoverage = 1u;  // layered targets: area of the fragments of a cell, in voxel faces
const uint kUnitAlbedo = 2u;    // sum of albedos times areas
const uint kUnitNormal = 3u;    // sum of normals times areas

// An occupied cell of a layered target, with the sums over its fragments.
LUCARNE_STRUCT(FoundVoxel) {
    uint cell;               // Grid::number()
    float area;              // voxel faces
    float red, green, blue;  // linear Rec. 709, times areas
    float normal_x, normal_y, normal_z;
};

#ifdef __cplusplus
static_assert(sizeof(FoundVoxel) == 32);
}  // namespace lucarne::gi::volume
#endif
#endif
