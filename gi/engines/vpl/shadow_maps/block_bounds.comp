// Computes the bounds of the casters in a block of the cut: one invocation a block.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/surfel.h"
#include "gi/engines/vpl/shadow_maps/casters.glsl"

layout(std430, binding = kBindBounds) writeonly buffer Bounds { vec4 bounds[]; };  // layout: queue.glsl

uniform uint block_count;

void main() {
    uint block = gl_GlobalInvocationID.x;
    if (block >= block_count) return;
    vec4 low = vec4(vec3(3e38), 0.0), high = vec4(vec3(-3e38), 0.0);
    for (uint i = 0u; i < kBlockSurfels; ++i) {
        Caster caster = read_caster(block * kBlockSurfels + i);
        if (caster.radius == 0.0) continue;  // an outlier, or beyond the last surfel
        low = vec4(min(low.xyz, caster.position), max(low.w, caster.lod_area));
        high = vec4(max(high.xyz, caster.position), max(high.w, caster.radius));
    }
    bounds[2u * block] = low;
    bounds[2u * block + 1u] = high;
}
