// Sums luminances over one run of pixels per invocation, in order, so that the result is the same every time.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/luminance.h"

layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindSums) writeonly buffer Sums { vec2 sums[]; };
uniform uint pixels;
uniform uint run;      // pixels an invocation
uniform float floor_luminance;  // 0: sum luminances; else logarithms of luminances no smaller than this

void main() {
    uint part = gl_GlobalInvocationID.x;
    vec2 sum = vec2(0.0);  // sum and number of pixels
    if (part * run >= pixels) return;
    uint last = min((part + 1u) * run, pixels);
    for (uint at = part * run; at < last; ++at) {
        float value = luminance(radiance[at].rgb);
        if (!(value > 0.0) || isinf(value)) continue;
        sum += vec2(floor_luminance > 0.0 ? log2(max(value, floor_luminance)) : value, 1.0);
    }
    sums[part] = sum;
}
