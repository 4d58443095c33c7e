// The queues that the order pass fills for the kernels after it, shared by C++ and GLSL (std430).
#ifndef LUCARNE_GI_GBUFFER_QUEUES_H
#define LUCARNE_GI_GBUFFER_QUEUES_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kLargeQueue = 65535u;    // discs: the number of workgroups in x that OpenGL guarantees
const uint kCandidateGroup = 256u;  // candidates that a workgroup draws
const uint kGroupRow = 32768u;

// Header before the ids of the large discs. It holds numbers of workgroups: large_groups draws the queue of
// large discs, overflow_groups searches the whole cut for large discs if the queue was too short,
// candidate_groups draws the ids of the candidates, seen_groups blends the discs of the blocks that are seen.
struct QueueHeader {
    uint large_groups[3];
    uint overflow_groups[3];
    uint candidate_groups[3];
    uint large_count;      // large discs found, also beyond the end of the queue
    uint candidate_count;  // small discs that were nearest in a pixel when they were drawn
    uint seen_count;       // blocks of which a disc took a pixel
    uint seen_groups[3];   // one for each of them, in rows of kGroupRow
    uint pad;
};

#ifdef __cplusplus
static_assert(sizeof(QueueHeader) == 64);
}  // namespace lucarne::gi
#endif
#endif
