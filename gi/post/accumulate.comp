// The running mean of pictures.
layout(local_size_x = 256) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindRadiance) readonly buffer Sample {
    vec4 taken[];
};
layout(std430, binding = kBindMean) buffer Mean {
    vec4 mean[];
};
uniform uint pixels;
uniform uint count;  // number of samples, including this one

void main() {
    uint i = thread_number();
    if (i >= pixels) return;
    mean[i] = count <= 1u ? taken[i] : mean[i] + (taken[i] - mean[i]) / float(count);
}
