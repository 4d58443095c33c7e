// Writes a picture in which pixels at edges show parts of their neighbours, one invocation a pixel.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/raster/coverage_code.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Sample { vec4 taken[]; };
layout(std430, binding = kBindMean) writeonly buffer Mean { vec4 mean[]; };
layout(std430, binding = kBindCoverage) readonly buffer Coverage { uint coverage[]; };
uniform uint pixels;
uniform uint width;
uniform uint points_only;  // 1: the light of pixels that show a point alone

void main() {
    uint at = thread_number();
    if (at >= pixels) return;
    uint word = coverage[at], own = kCoverageSamples;
    float points = 0.0, weights = 0.0;  // samples that show a point; samples that count
    vec3 light = vec3(0.0);
    for (uint i = 0u; i <= kCoverageNeighbours; ++i) {
        bool neighbour = i < kCoverageNeighbours;
        uint samples = neighbour ? word >> (4u * i) & 15u : own;
        if (samples == 0u) continue;
        ivec2 step = neighbour ? coverage_neighbour(i) : ivec2(0);
        int from = int(at) + step.y * int(width) + step.x;
        float weight = float(samples);
        if (neighbour) own -= samples;
        if (texelFetch(gbuffer_texels, from).x != 0u) points += weight;
        else if (points_only != 0u) continue;
        light += weight * taken[from].rgb;
        weights += weight;
    }
    mean[at] = vec4(weights > 0.0 ? light / weights : vec3(0.0), points / float(kCoverageSamples));
}
