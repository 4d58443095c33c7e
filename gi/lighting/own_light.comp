// Draws the light that reaches the eye without reflection: the emission of surfaces, and the background elsewhere.
layout(local_size_x = 64) in;
#include "gi/lighting/bindings.h"
#include "gi/shared/many_threads.glsl"
#include "gi/shared/environment.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/material.h"

layout(std430, binding = kBindCameraTexels) readonly buffer CameraTexels { GBufferTexel texels[]; };
layout(std430, binding = kBindLightingMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindLitRadiance) buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindSky) readonly buffer Sky { float sky[]; };  // r, g, b of each texel
uniform CameraView camera;
uniform uint sky_width;
uniform uint sky_height;
uniform float sky_rotation;

vec3 background(uint at) {
    vec3 ray = view_ray(camera, vec2(at % camera.width, at / camera.width) + 0.5);
    uvec2 texel = uvec2(environment_place(normalize(ray), sky_rotation) * vec2(sky_width, sky_height));
    texel = min(texel, uvec2(sky_width, sky_height) - 1u);
    uint first = 3u * (texel.y * sky_width + texel.x);
    return vec3(sky[first], sky[first + 1u], sky[first + 2u]);
}

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height) return;
    GBufferTexel texel = texels[at];
    vec3 light = texel.depth > 0.0 ? materials[texel_material(texel)].emission.xyz : background(at);
#ifdef LUCARNE_ADD  // add to the picture instead of replacing its content
    light += radiance[at].rgb;
#endif
    radiance[at] = vec4(light, 1.0);
}
