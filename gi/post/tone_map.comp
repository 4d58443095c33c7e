// Maps radiance to sRGB for the screen.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"
#include "gi/shared/surfel_code.h"
#include "gi/shared/tone_curve.h"

layout(std430, binding = kBindRadiance) readonly buffer Radiance {
    vec4 radiance[];
};
layout(std430, binding = kBindPicture) writeonly buffer Picture {
    uint picture[];
};
uniform uint pixels;
uniform vec4 scale;  // w is unused
uniform uint curve;
uniform float compression;  // of highlights

void main() {
    uint at = thread_number();
    if (at >= pixels) return;
    vec3 x = tone_curve(radiance[at].rgb * scale.rgb, curve, compression);
    uint word = 255u << 24;
    for (int i = 0; i < 3; ++i) word |= uint(linear_to_srgb(x[i]) * 255.0 + 0.5) << (8 * i);
    picture[at] = word;
}
