// Computes one level of the mip chain of the importance map from the level below: sums of 2 x 2 texels.
layout(local_size_x = 16, local_size_y = 16) in;

#include "gi/engines/vpl/seeding/importance.glsl"

uniform uint level;  // the level to write

void main() {
    uint side = importance_side >> level;
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= side || at.y >= side) return;
    uint below = importance_level(level - 1u) + 2u * at.y * (2u * side) + 2u * at.x;
    importance[importance_level(level) + at.y * side + at.x] =
        (importance[below] + importance[below + 1u]) +
        (importance[below + 2u * side] + importance[below + 2u * side + 1u]);
}
