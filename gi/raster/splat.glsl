// What the splatting kernels share: the targets, and how a disc takes a pixel. Two passes of 32 bits each, for want of
// 64-bit atomics: the first leaves the nearest key in each pixel, the second (LUCARNE_ID_PASS) the smallest id of those
// that have it.
#include "gi/raster/disc.glsl"
#include "gi/raster/queues.h"

layout(std430, binding = 3) buffer Keys { uint keys[]; };
layout(std430, binding = 4) buffer Ids { uint ids[]; };
layout(std430, binding = 5) buffer Queues {
    QueueHeader queues;
    uint large_ids[];
};
// The keys again, four a texel; perhaps not the latest in the first pass.
layout(binding = 3) uniform usamplerBuffer key_texels;

// Discs of a larger radius, in pixels, are drawn by a workgroup each.
const float kSmallRadius = 8.0;
bool is_small(Disc disc) {
    vec2 pixels = disc.radius * pixels_per_tangent();
    return max(pixels.x, pixels.y) <= kSmallRadius * view_scale(disc.centre.z);
}

uint pixel_index(vec2 pixel) { return uint(pixel.y) * view_width + uint(pixel.x); }

// Whether it is worth asking for the pixel.
bool may_take_pixel(vec2 pixel, uint key) {
    // Four words and a choice take less time on llvmpipe than one: x86 gathers single words slowly.
    int index = int(pixel_index(pixel));
    uvec4 four = texelFetch(key_texels, index >> 2);
    uvec2 two = (index & 2) == 0 ? four.xy : four.zw;
    uint held = (index & 1) == 0 ? two.x : two.y;
#ifdef LUCARNE_ID_PASS
    return key == held;
#else
    return key <= held;
#endif
}

// True where the disc was the nearest yet, or one of them: no other's id can end up in the pixel.
bool take_pixel(vec2 pixel, uint key, uint id) {
#ifdef LUCARNE_ID_PASS
    atomicMin(ids[pixel_index(pixel)], id);
    return true;
#else
    return atomicMin(keys[pixel_index(pixel)], key) >= key;
#endif
}
