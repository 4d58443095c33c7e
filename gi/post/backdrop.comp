// Fills the pixels that show no point with a gradient from the top colour to the bottom colour, and the part of a
// pixel that shows none in an average of frames.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindPicture) buffer Picture { uint picture[]; };
uniform uint averaged;  // 1: w of the radiance is the share of the pixel that shows points
uniform vec4 top;  // sRGB
uniform vec4 bottom;
uniform uint width;
uniform uint height;

void main() {
    uint at = thread_number();
    if (at >= width * height) return;
    float coverage = texelFetch(gbuffer_texels, int(at)).x != 0u ? 1.0 : 0.0;
    if (averaged != 0u) coverage = radiance[at].w;
    if (coverage >= 1.0) return;
    float down = (float(at / width) + 0.5) / float(height);
    vec4 behind = mix(top, bottom, down);
    picture[at] = packUnorm4x8(coverage > 0.0 ? mix(behind, unpackUnorm4x8(picture[at]), coverage) : behind);
}
