// The queue of discs that are too large for one invocation, shared by C++ and GLSL (std430).
#ifndef LUCARNE_GI_GBUFFER_LARGE_H
#define LUCARNE_GI_GBUFFER_LARGE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kLargeQueue = 65535u;  // discs: the least that OpenGL promises of workgroups in x

// Ahead of the queue's ids. queue_groups draws the queue, overflow_groups looks through the whole cut for
// what did not find a place in it.
struct LargeHeader {
    uint queue_groups[3];
    uint overflow_groups[3];
    uint count;  // of discs that asked for a place
    uint pad;
};

#ifdef __cplusplus
static_assert(sizeof(LargeHeader) == 32);
}  // namespace lucarne::gi
#endif
#endif
