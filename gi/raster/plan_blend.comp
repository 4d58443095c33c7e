// Runs after resolve.comp and computes how many workgroups blend the blocks that are seen.
layout(local_size_x = 1) in;
#include "gi/raster/bindings.h"
#include "gi/raster/queues.h"

layout(std430, binding = kBindQueues) buffer Queues { QueueHeader queues; };

void main() {
    uint rows = (queues.seen_count + kGroupRow - 1u) / kGroupRow;
    queues.seen_groups = uint[3](min(queues.seen_count, kGroupRow), rows, 1u);
}
