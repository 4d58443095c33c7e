// The running mean of pictures.
layout(local_size_x = 256) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Sample {
    vec4 taken[];
};
layout(std430, binding = kBindMean) buffer Mean {
    vec4 mean[];
};
uniform uint pixels;
uniform uint count;  // number of samples, including this one
uniform uint points_only;  // 1: average the samples that show a point

void main() {
    uint i = thread_number();
    if (i >= pixels) return;
    float covered = texelFetch(gbuffer_texels, int(i)).x != 0u ? 1.0 : 0.0;
    vec4 before = count <= 1u ? vec4(0.0) : mean[i];
    float coverage = before.w + (covered - before.w) / float(count);
    float share = 1.0 / float(count);
    if (points_only != 0u) share = covered > 0.0 ? share / coverage : 0.0;
    vec3 light = share >= 1.0 ? taken[i].rgb : before.rgb + (taken[i].rgb - before.rgb) * share;
    mean[i] = vec4(light, coverage);
}
