// The queue of (surfel, map) pairs between enter.comp and splat.comp.
layout(std430, binding = 11) buffer Queue {
    uint queue_count;  // pairs that asked for a place; more than there is room for: the range is drawn in halves
    uint queue_unused[3];
    uvec2 queue[];
};

void queue_pair(uint id, uint map) {
    uint place = atomicAdd(queue_count, 1u);
    if (place < uint(queue.length())) queue[place] = uvec2(id, map);
}
