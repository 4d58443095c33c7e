// Maps the illuminance of surfaces to a ramp of colours.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/luminance.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindPicture) writeonly buffer Picture { uint picture[]; };
layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
uniform uint pixels;
#include "gi/post/ramp.glsl"

// Black paint hardly tells what shines on it.
const float kLeastReflectance = 0.01;

void main() {
    uint at = thread_number();
    if (at >= pixels) return;
    uvec4 texel = texelFetch(gbuffer_texels, int(at));
    Material material = materials[(texel.w & 0xffffu) % LUCARNE_DEVICE_MATERIALS];
    Reflectance surface = make_reflectance(material, decode_albedo(texel.z));
    vec3 reflected = max(radiance[at].rgb - material.emission.rgb, vec3(0.0));
    float received = luminance(kPi * reflected / max(surface.kd + surface.ks, vec3(kLeastReflectance)));
    picture[at] = ramp_colour(logarithm(texel.x != 0u ? received : 0.0));
}
