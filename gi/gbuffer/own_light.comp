// What reaches the eye without being reflected: emission of surfaces, and the background where there is none.
layout(local_size_x = 64) in;
#include "gi/shared/gbuffer.glsl"
#include "gi/shared/material.h"

layout(std430, binding = 3) readonly buffer CameraTexels { GBufferTexel texels[]; };
layout(std430, binding = 5) readonly buffer Materials { Material materials[]; };
layout(std430, binding = 6) buffer Radiance { vec4 radiance[]; };
uniform uint pixels;
uniform vec3 background;
uniform uint add;  // 0: in the place of what the picture held

void main() {
    uint at = gl_GlobalInvocationID.x;
    if (at >= pixels) return;
    GBufferTexel texel = texels[at];
    uint material = min(texel_material(texel), uint(materials.length()) - 1u);
    vec3 light = texel.depth > 0.0 ? materials[material].emission.xyz : background;
    radiance[at] = vec4(add != 0u ? radiance[at].rgb + light : light, 1.0);
}
