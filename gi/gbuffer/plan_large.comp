// Decides who draws the large discs: the queue's kernel, or with too many of them the one that needs no queue.
layout(local_size_x = 1) in;
#include "gi/gbuffer/large.h"

layout(std430, binding = 5) buffer Large { LargeHeader large; };
uniform uint blocks;  // of the cut

void main() {
    bool fits = large.count <= kLargeQueue;
    large.queue_groups = uint[3](fits ? large.count : 0u, 1u, 1u);
    large.overflow_groups = uint[3](fits ? 0u : blocks, 1u, 1u);
}
