// Shared by the splatting kernels: the targets, and how a disc takes a pixel. Without 64-bit atomics this takes two
// passes of 32 bits each. The first leaves the nearest key in each pixel, the second (LUCARNE_ID_PASS) the smallest
// id of the discs with that key.
#include "gi/raster/bindings.h"
#include "gi/raster/disc.glsl"
#include "gi/raster/queues.h"

layout(std430, binding = kBindKeys) buffer Keys { uint keys[]; };
layout(std430, binding = kBindIds) buffer Ids { uint ids[]; };
layout(std430, binding = kBindQueues) buffer Queues {
    QueueHeader queues;
    uint large_ids[];
};
// The keys again, four a texel; in the first pass perhaps not the latest ones.
layout(binding = kUnitKeys) uniform usamplerBuffer key_texels;

// Returns whether the disc may take the pixel; saves the atomic operation if it cannot.
bool may_take_pixel(vec2 pixel, uint key) {
    // Fetching four words and choosing one is faster on llvmpipe than fetching one: x86 gathers single words slowly.
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

// Takes the pixel if the disc is nearest. Returns whether it is the nearest so far, or one of the nearest: only ids
// of such discs can end up in the pixel.
bool take_pixel(vec2 pixel, uint key, uint id) {
#ifdef LUCARNE_ID_PASS
    atomicMin(ids[pixel_index(pixel)], id);
    return true;
#else
    return atomicMin(keys[pixel_index(pixel)], key) >= key;
#endif
}
