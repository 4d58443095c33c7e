// Replaces the texel of each pixel by the weighted mean of the discs that were added to its sums; one invocation a pixel.
// Pixels without sums keep their front disc. Sets the sums back to zero for the next picture: that is much faster on
// llvmpipe than clearing the buffer.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/blend_sums.h"
#include "gi/raster/slab.glsl"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindSums) writeonly buffer Sums { uint sums[]; };
layout(binding = kUnitSums) uniform usamplerBuffer sum_texels;  // the same, four words a texel
layout(std430, binding = kBindTexels) buffer Texels { GBufferTexel texels[]; };

void main() {
    uint place = thread_number(), pixel = place + band_first * view_width;
    if (pixel >= band_end * view_width) return;
    uvec4 low = texelFetch(sum_texels, int(2u * place)), high = texelFetch(sum_texels, int(2u * place + 1u));
    uint weight = low.x;
    if (weight == 0u) return;
    for (uint i = 0u; i < kSumWords; ++i) sums[place * kSumWords + i] = 0u;
    if (weight > kMostWeight) return;
    GBufferTexel texel = texels[pixel];
    vec2 tangent = pixel_tangent(vec2(pixel % view_width, pixel / view_width));
    float scale = 1.0 / (float(weight) * kValueSteps);
    vec3 colour = vec3(low.yzw) * scale;
    vec3 normal = 2.0 * vec3(high.xyz) * scale - 1.0;
    float offset = 2.0 * float(high.w) * scale - 1.0;
    texel.depth += offset / slab_of(texel, tangent).scale;
    bool behind = dot(normal, world_ray(tangent)) > 0.0;
    bool has_normal = (texel.albedo & kSurfelHasNormal) != 0u;
    texel.normal = encode_octahedral(normalize(behind ? -normal : normal));
    texel.albedo = encode_albedo(colour);
    if (has_normal) texel.albedo |= kSurfelHasNormal | (behind ? kTexelFromBehind : 0u);
    texels[pixel] = texel;
}
