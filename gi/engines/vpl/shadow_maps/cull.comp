// Culls blocks of the cut against maps: one invocation a block and 32 maps of the run. It sets a bit for each map
// into which the block may have to be drawn. Nearly all pairs are culled here: a block of fine surfels only matters
// to the VPLs around it.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/lights.glsl"
#include "gi/engines/vpl/shadow_maps/queue.glsl"
#include "gi/engines/vpl/shadow_maps/thinning.glsl"

uniform uint first_block, block_end, first_map, map_end;

void main() {
    uint block = first_block + gl_GlobalInvocationID.x;
    uint word = gl_GlobalInvocationID.y;
    if (block >= block_end) return;
    vec4 low = uintBitsToFloat(texelFetch(block_bounds, int(2u * block)));
    vec4 high = uintBitsToFloat(texelFetch(block_bounds, int(2u * block + 1u)));
    uint met = 0u;
    for (uint i = 0u; i < 32u && first_map + word * 32u + i < map_end; ++i) {
        uint map = first_map + word * 32u + i;
        vec3 centre = vpl_map_centre(map);
        vec3 normal = vpl_normal(map).xyz;
        vec3 outside = clamp(centre, low.xyz, high.xyz) - centre;
        vec3 farthest = max(centre - low.xyz, high.xyz - centre);
        float height = dot(normal, mix(low.xyz, high.xyz, vec3(greaterThan(normal, vec3(0.0)))) - centre);
        bool over = height + high.w + kLargestSplat * splat_angle * length(farthest) > 0.0;
        met |= over && low.w >= needed_area(dot(outside, outside), 1.0) ? 1u << i : 0u;
    }
    meetings[block * kRunWords + word] = met;
}
