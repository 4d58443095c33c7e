// Radiance to sRGB for the screen.
layout(local_size_x = 64) in;
#include "gi/shared/surfel_code.h"

layout(std430, binding = 0) readonly buffer Radiance {
    vec4 radiance[];
};
layout(std430, binding = 1) writeonly buffer Picture {
    uint picture[];
};
uniform uint pixels;
uniform float scale;
uniform uint curve;  // 0: filmic, 1: Reinhard, 2: none

// Narkowicz 2015, "ACES filmic tone mapping curve": a fit of the ACES reference transform, channel by
// channel.
vec3 filmic(vec3 x) {
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

// Reinhard et al. 2002, "Photographic tone reproduction for digital images", eq. 3, on luminance (Rec. 709).
vec3 reinhard(vec3 x) {
    return x / (1.0 + dot(x, vec3(0.2126, 0.7152, 0.0722)));
}

void main() {
    uint at = gl_GlobalInvocationID.x;
    if (at >= pixels) return;
    vec3 x = radiance[at].rgb * scale;
    // Beyond 10^4 every curve is white; the bound keeps infinity out of the quotients.
    for (int i = 0; i < 3; ++i) x[i] = x[i] > 0.0 ? min(x[i], 1e4) : 0.0;
    if (curve == 0u) x = filmic(x);
    if (curve == 1u) x = reinhard(x);
    uint word = 255u << 24;
    for (int i = 0; i < 3; ++i) word |= uint(linear_to_srgb(clamp(x[i], 0.0, 1.0)) * 255.0 + 0.5) << (8 * i);
    picture[at] = word;
}
