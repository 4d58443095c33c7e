// Pull: computes half the resolution of every map (after Marroquim, Kraus, Cavalcanti 2007).
//
// A coarse texel represents the nearest sheet among its 2 x 2 children if at least three of them lie within the depth
// interval [d, d + 2 r] of the nearest. A fourth child that is empty or deeper is then a hole between splats. Two
// against two is the edge of a real opening: the coarse texel is open and fills nothing. All children belong to one
// map.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/shadow_maps/pyramid.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    uint map = gl_GlobalInvocationID.z;
    if (max(at.x, at.y) >= map_side / 2u) return;
    uint child[4];
    uint nearest = kNothing;
    for (uint i = 0u; i < 4u; ++i) {
        child[i] = atlas[texel_index(map, 2u * at + uvec2(i & 1u, i >> 1))];
        nearest = min(nearest, child[i]);
    }
    uint value = nearest;
    if (nearest < kOpen) {
        float deepest = sheet_end(nearest);
        float sum = 0.0;
        uint support = 0u;
        for (uint i = 0u; i < 4u; ++i) {
            if (child[i] >= kOpen || map_distance(child[i]) > deepest) continue;
            sum += map_distance(child[i]);
            ++support;
        }
        value = support >= 3u ? pack_map_texel(sum / float(support), nearest & 0xffffu) : kOpen;
    }
    coarse[coarse_index(map, at)] = value;
}
