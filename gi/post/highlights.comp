// Counts the pixels that show points by their brightness, in blocks of 4 x 4 pixels: the light of a block is its mean,
// so that single noisy pixels are no highlights. Integers are counted, so that the result is the same every time.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindCounts) buffer Counts { uint counts[]; };
uniform uint width;
uniform uint height;
uniform vec4 balance;  // w is unused
uniform float log_mean;  // of luminance, base 2: the middle of the bins

shared uint group_counts[kBrightnessBins];

void count_block(uvec2 first) {
    vec3 sum = vec3(0.0);
    uint seen = 0u;
    for (uint y = first.y; y < min(first.y + kBlockSide, height); ++y)
        for (uint x = first.x; x < min(first.x + kBlockSide, width); ++x) {
            uint at = y * width + x;
            vec3 light = radiance[at].rgb;
            if (texelFetch(gbuffer_texels, int(at)).x == 0u || any(isnan(light)) || any(isinf(light))) continue;
            sum += light;
            ++seen;
        }
    sum *= balance.rgb;
    float brightest = max(sum.r, max(sum.g, sum.b)) / float(max(seen, 1u));
    if (seen == 0u) return;
    float stops = brightest > 0.0 ? log2(brightest) - log_mean : -1e3;
    int bin = int(floor(stops * kBinsPerStop)) + kBrightnessBins / 2;
    atomicAdd(group_counts[clamp(bin, 0, kBrightnessBins - 1)], seen);
}

void main() {
    for (uint bin = gl_LocalInvocationIndex; bin < kBrightnessBins; bin += 64u) group_counts[bin] = 0u;
    barrier();
    uint across = (width + kBlockSide - 1u) / kBlockSide, down = (height + kBlockSide - 1u) / kBlockSide;
    uint block = thread_number();
    if (block < across * down) count_block(kBlockSide * uvec2(block % across, block / across));
    barrier();
    for (uint bin = gl_LocalInvocationIndex; bin < kBrightnessBins; bin += 64u)
        if (group_counts[bin] != 0u) atomicAdd(counts[bin], group_counts[bin]);
}
