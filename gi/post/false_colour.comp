// Maps luminances, or the differences of two pictures' luminances, to a ramp of colours.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"
#include "gi/shared/luminance.h"

layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindPicture) writeonly buffer Picture { uint picture[]; };
layout(std430, binding = kBindOther) readonly buffer Other { vec4 other[]; };
uniform uint pixels;
uniform uint mode;  // 0: logarithm of the luminance, 1: signed difference, 2: absolute difference
#include "gi/post/ramp.glsl"

void main() {
    uint at = thread_number();
    if (at >= pixels) return;
    float own = luminance(radiance[at].rgb);
    float value = logarithm(own);
    if (mode != 0u) value = own - luminance(other[at].rgb);
    if (mode == 2u) value = abs(value);
    picture[at] = ramp_colour(value);
}
