// Shows one picture left of a border and another right of it.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindOther) readonly buffer Other { uint other[]; };
layout(std430, binding = kBindPicture) buffer Picture { uint picture[]; };
uniform uint pixels;
uniform uint width;
uniform uint border;  // first column of the other picture

void main() {
    uint at = thread_number();
    if (at < pixels && at % width >= border) picture[at] = other[at];
}
