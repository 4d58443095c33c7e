// Fills the pixels that show no point with a gradient from the top colour to the bottom colour.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindPicture) buffer Picture { uint picture[]; };
uniform vec4 top;  // sRGB
uniform vec4 bottom;
uniform uint width;
uniform uint height;

void main() {
    uint at = thread_number();
    if (at >= width * height || texelFetch(gbuffer_texels, int(at)).x != 0u) return;
    float down = (float(at / width) + 0.5) / float(height);
    picture[at] = packUnorm4x8(mix(top, bottom, down));
}
