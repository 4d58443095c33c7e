// The queues that the order pass leaves to the kernels after it, shared by C++ and GLSL (std430).
#ifndef LUCARNE_GI_GBUFFER_QUEUES_H
#define LUCARNE_GI_GBUFFER_QUEUES_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kLargeQueue = 65535u;    // discs: the least that OpenGL promises of workgroups in x
const uint kCandidateGroup = 256u;  // candidates drawn by a workgroup

// Ahead of the ids of the large discs. The numbers of workgroups: large_groups draws their queue,
// overflow_groups looks through the whole cut for what did not find a place in it, candidate_groups draws the
// candidates' ids.
struct QueueHeader {
    uint large_groups[3];
    uint overflow_groups[3];
    uint candidate_groups[3];
    uint large_count;      // of discs that asked for a place
    uint candidate_count;  // of small discs that were nearest in a pixel when they were drawn
    uint pad;
};

#ifdef __cplusplus
static_assert(sizeof(QueueHeader) == 48);
}  // namespace lucarne::gi
#endif
#endif
