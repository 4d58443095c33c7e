// Half the resolution of every map of the atlas, for pull and push.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"

layout(std430, binding = kBindCoarse) buffer Coarse { uint coarse[]; };

// Returns the end of the depth interval [d, d + 2 r] of a sheet in the neighbourhood of a texel.
float sheet_end(uint texel) {
    float distance_m = map_distance(texel);
    return distance_m + 2.0 * splat_radius(map_radius(texel), distance_m);
}

uint coarse_index(uint map, uvec2 at) {
    uint side = map_side / 2u;
    return (map * side + at.y) * side + at.x;
}
