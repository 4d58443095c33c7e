// What the two splatting kernels share: the targets, and how a disc takes a pixel.
#include "gi/gbuffer/disc.glsl"

layout(std430, binding = 3) buffer Keys { uint keys[]; };
layout(std430, binding = 4) buffer Ids { uint ids[]; };
layout(std430, binding = 5) buffer Large {
    uint large_groups[3];  // of the indirect dispatch that draws the queue
    uint large_count;      // of discs that asked for a place
    uint large_ids[];
};

uniform uint id_pass;  // 0: the nearest key a pixel; 1: the smallest id among those with that key

void take_pixel(Disc disc, uint id, ivec2 pixel, ivec2 home) {
    uint key = disc_key(disc, pixel_tangent(vec2(pixel)), pixel == home);
    uint at = uint(pixel.y) * view_width + uint(pixel.x);
    if (id_pass == 0u) {
        if (key < keys[at]) atomicMin(keys[at], key);
    } else if (key != kNoKey && key == keys[at]) {
        atomicMin(ids[at], id);
    }
}
