// Lists the occupied cells of some layers of a layered target, in any order.
#include "gi/shared/many_threads.glsl"
#include "gi/volume/triangles/bindings.h"

layout(local_size_x = 64) in;

layout(binding = kUnitCoverage) uniform sampler3D coverage;
#ifdef LUCARNE_ALBEDO
layout(binding = kUnitAlbedo) uniform sampler3D albedo_sum;
#endif
#ifdef LUCARNE_NORMAL
layout(binding = kUnitNormal) uniform sampler3D normal_sum;
#endif
layout(std430, binding = kBindFound) writeonly buffer Found { FoundVoxel found[]; };
layout(std430, binding = kBindCount) buffer Count { uint count; };

uniform int axis;
uniform uint across, down;              // cells of a layer
uniform uint first_layer, layer_count;  // which to look at
uniform uint grid_width, grid_height;   // of the grid itself, voxels

void main() {
    uint number = thread_number();
    if (number >= across * down * layer_count) return;
    ivec3 at = ivec3(number % across, number / across % down, first_layer + number / (across * down));
    float area = texelFetch(coverage, at, 0).x;
    if (!(area > 0.0)) return;
    // The turn of sweep_axis.glsl, undone.
    uvec3 cell = uvec3(axis == 0 ? at.zxy : axis == 1 ? at.yzx : at);
    FoundVoxel voxel = FoundVoxel((cell.z * grid_height + cell.y) * grid_width + cell.x, area, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
#ifdef LUCARNE_ALBEDO
    vec4 albedo = texelFetch(albedo_sum, at, 0);
    voxel.red = albedo.x;
    voxel.green = albedo.y;
    voxel.blue = albedo.z;
#endif
#ifdef LUCARNE_NORMAL
    vec4 normal = texelFetch(normal_sum, at, 0);
    voxel.normal_x = normal.x;
    voxel.normal_y = normal.y;
    voxel.normal_z = normal.z;
#endif
    found[atomicAdd(count, 1u)] = voxel;
}
