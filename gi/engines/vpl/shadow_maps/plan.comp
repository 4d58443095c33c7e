// Runs after enqueue.comp, and again after splat.comp, and computes how many workgroups draw what they have queued.
layout(local_size_x = 1) in;

#include "gi/engines/vpl/shadow_maps/queue.glsl"

uniform uint places;  // length of pairs[]

void main() {
    uint pairs_that_fit = queues[queue].pair_count <= places ? queues[queue].pair_count : 0u;
    queues[queue].pair_groups = uint[3]((pairs_that_fit + kSplatGroup - 1u) / kSplatGroup, 1u, 1u);
    queues[queue].large_groups = uint[3](min(queues[queue].large_count, kMostLargeGroups), 1u, 1u);
}
