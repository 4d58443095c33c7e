// Computes the bounds of all points that a picture shows: one invocation a pixel.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/sky/ordered.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindGBuffer) readonly buffer Pixels { GBufferTexel pixels[]; };
layout(std430, binding = kBindBounds) buffer Found { uint found[6]; };  // codes of the least and greatest x, y, z

uniform CameraView camera;

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height || !(pixels[at].depth > 0.0)) return;
    vec3 position = texel_position(camera, vec2(at % camera.width, at / camera.width), pixels[at]);
    for (int axis = 0; axis < 3; ++axis) {
        uint code = ordered_code(position[axis]);
        // Most points lie within the bounds by then.
        if (code < found[axis]) atomicMin(found[axis], code);
        if (code > found[3 + axis]) atomicMax(found[3 + axis], code);
    }
}
