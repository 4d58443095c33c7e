// Push: fills the holes of every map from its half resolution (after Marroquim, Kraus, Cavalcanti 2007).
//
// A texel that is empty, or lies behind the depth interval of the sheet around it, takes the mean of the four nearest
// coarse texels, weighted 9-3-3-1, if all four belong to the same sheet. Nothing is read across the border of a map.
// A door stays open: around a texel inside it the coarse texels are open or as deep as the texel itself.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/shadow_maps/pyramid.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    uint map = gl_GlobalInvocationID.z;
    if (max(at.x, at.y) >= map_side) return;
    uint own = atlas[texel_index(map, at)];
    if (own == kOpen) return;

    uvec2 parent = at / 2u;
    uint nearest = coarse[coarse_index(map, parent)];
    if (nearest >= kOpen) return;  // most texels end here or at the next line
    if (own < kOpen && map_distance(own) <= sheet_end(nearest)) return;

    // The neighbours of its parent on the side where the texel lies.
    ivec2 side_step = ivec2(at & 1u) * 2 - 1;
    uvec2 other = uvec2(clamp(ivec2(parent) + side_step, ivec2(0), ivec2(map_side / 2u) - 1));
    uint around[4] = uint[4](nearest, coarse[coarse_index(map, uvec2(other.x, parent.y))],
                             coarse[coarse_index(map, uvec2(parent.x, other.y))],
                             coarse[coarse_index(map, other)]);
    const float weight[4] = float[4](9.0 / 16.0, 3.0 / 16.0, 3.0 / 16.0, 1.0 / 16.0);
    for (uint i = 1u; i < 4u; ++i) nearest = min(nearest, around[i]);
    float deepest = sheet_end(nearest);
    float mean = 0.0;
    for (uint i = 0u; i < 4u; ++i) {
        if (around[i] >= kOpen || map_distance(around[i]) > deepest) return;
        mean += weight[i] * map_distance(around[i]);
    }
    atlas[texel_index(map, at)] = pack_map_texel(mean, nearest & 0xffffu);
}
