// Cuts the footprint of each VPL down to the part of its disc that lies in the room; a workgroup a map. A footprint
// follows from the density of the VPLs. In a corner, or on something small, a disc of that size sticks into the
// walls, and what its rim sends lands nowhere. The VPL's own map shows how far its plane is clear. The area that is
// left is pi times the mean, over directions low above the horizon, of the squared distance to the blocker along the
// plane, at most the squared radius.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/groups.h"
#include "gi/shared/brdf.h"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"
#include "gi/engines/vpl/vpl_light.h"

layout(local_size_x = kTrimGroup) in;

layout(std430, binding = kBindLights) buffer Lights {
    VplLight lights[];
};
layout(binding = kUnitAtlas) uniform usamplerBuffer atlas_texels;

uniform float shrink;

shared float shared_sum[kTrimGroup], shared_count[kTrimGroup];

const float kLowestRing = 0.95, kHighestRing = 0.5;  // u^2 + v^2: elevations from 1.5 to 20 degrees

void main() {
    uint map = gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    float r2 = lights[map].position.w / kPi;
    float sum = 0.0, count = 0.0;
    for (uint i = lane; i < map_side * map_side; i += kTrimGroup) {
        vec2 uv = texel_centre(uvec2(i % map_side, i / map_side));
        float norm2 = dot(uv, uv);
        if (norm2 > kLowestRing || norm2 < kHighestRing) continue;
        uint texel = texelFetch(atlas_texels, int(map * map_side * map_side + i)).x;
        float along = map_distance(texel) * 2.0 * sqrt(norm2) / (1.0 + norm2);
        sum += texel == kNothing ? r2 : min(r2, along * along);
        count += 1.0;
    }
    shared_sum[lane] = sum;
    shared_count[lane] = count;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < kTrimGroup; ++i) {
        sum += shared_sum[i];
        count += shared_count[i];
    }
    if (count > 0.0) lights[map].position.w = shrink * kPi * sum / count;
}
