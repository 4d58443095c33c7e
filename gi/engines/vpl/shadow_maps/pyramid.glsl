// The pyramid over every map of the atlas, for pull and push; level 0 is the atlas itself.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"

layout(std430, binding = kBindCoarse) buffer Coarse { uint coarse[]; };  // levels 1, 2, ... one after the other

uniform uint level;  // the level to write
uniform uint maps;

// Returns the end of the depth interval [d, d + 2 r] of a sheet in the neighbourhood of a texel.
float sheet_end(uint texel) {
    float distance_m = map_distance(texel);
    return distance_m + 2.0 * splat_radius(map_radius(texel), distance_m);
}

uint coarse_index(uint l, uint map, uvec2 at) {  // l > 0
    uint first = 0u;
    for (uint i = 1u; i < l; ++i) first += maps * (map_side >> i) * (map_side >> i);
    return first + (map * (map_side >> l) + at.y) * (map_side >> l) + at.x;
}

uint pyramid_texel(uint l, uint map, uvec2 at) {
    return l == 0u ? atlas[texel_index(map, at)] : coarse[coarse_index(l, map, at)];
}
void set_pyramid_texel(uint l, uint map, uvec2 at, uint value) {
    if (l == 0u)
        atlas[texel_index(map, at)] = value;
    else
        coarse[coarse_index(l, map, at)] = value;
}
