// After the order pass over all surfels: how many workgroups the queues take. The large discs' kernel needs a place
// for each of them, or the one that needs no queue draws them.
layout(local_size_x = 1) in;
#include "gi/raster/queues.h"

layout(std430, binding = 5) buffer Queues { QueueHeader queues; };
uniform uint blocks;  // of the cut

void main() {
    bool fits = queues.large_count <= kLargeQueue;
    queues.large_groups = uint[3](fits ? queues.large_count : 0u, 1u, 1u);
    queues.overflow_groups = uint[3](fits ? 0u : blocks, 1u, 1u);
    queues.candidate_groups = uint[3]((queues.candidate_count + kCandidateGroup - 1u) / kCandidateGroup, 1u, 1u);
}
