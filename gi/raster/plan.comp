// Runs after the order pass over all surfels and computes how many workgroups the queues need. The kernel of large
// discs needs all of them in the queue; otherwise the overflow kernel, which reads no queue, draws them.
layout(local_size_x = 1) in;
#include "gi/raster/bindings.h"
#include "gi/raster/queues.h"

layout(std430, binding = kBindQueues) buffer Queues { QueueHeader queues; };
uniform uint blocks;  // of the cut

void main() {
    bool fits = queues.large_count <= kLargeQueue;
    queues.large_groups = uint[3](fits ? queues.large_count : 0u, 1u, 1u);
    queues.overflow_groups = uint[3](fits ? 0u : blocks, 1u, 1u);
    queues.candidate_groups = uint[3]((queues.candidate_count + kCandidateGroup - 1u) / kCandidateGroup, 1u, 1u);
}
