// Fills pixels without points that lie between points. Looks for the nearest pixel with points in eight directions.
layout(local_size_x = 64) in;
#include "gi/post/bindings.h"
#include "gi/shared/many_threads.glsl"

layout(binding = kUnitGBuffer) uniform usamplerBuffer gbuffer_texels;
layout(std430, binding = kBindRadiance) readonly buffer Radiance { vec4 radiance[]; };
// Pixels with points are only read, and the others only written: each by its own thread.
layout(std430, binding = kBindPicture) buffer Picture { uint picture[]; };
uniform uint averaged;  // 1: w of the radiance is the share of the pixel that shows points
uniform uint reach;     // pixels
uniform uint width;
uniform uint height;

// Opposite directions follow each other.
const ivec2 kDirections[8] = ivec2[8](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(1, 1),
                                      ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1));

bool has_points(uint at) {
    return averaged != 0u ? radiance[at].w > 0.0 : texelFetch(gbuffer_texels, int(at)).x != 0u;
}

void main() {
    uint at = thread_number();
    if (at >= width * height || has_points(at)) return;
    ivec2 here = ivec2(int(at % width), int(at / width));
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    int between = 0;  // axes along which there are points on both sides
    for (int axis = 0; axis < 4; ++axis) {
        int sides = 0;
        for (int side = 0; side < 2; ++side) {
            ivec2 direction = kDirections[2 * axis + side];
            for (int step = 1; step <= int(reach); ++step) {
                ivec2 there = here + step * direction;
                if (any(lessThan(there, ivec2(0))) || there.x >= int(width) || there.y >= int(height)) break;
                uint other = uint(there.y) * width + uint(there.x);
                if (!has_points(other)) continue;
                float weight = 1.0 / float(step * step);
                sum += weight * unpackUnorm4x8(picture[other]);
                weights += weight;
                ++sides;
                break;
            }
        }
        if (sides == 2) ++between;
    }
    if (between >= 2) picture[at] = packUnorm4x8(sum / weights);
}
