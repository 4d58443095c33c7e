// The queues between enter.comp, splat.comp and splat_large.comp.
layout(std430, binding = 11) buffer Queue {
    uint queue_count;  // pairs that asked for a place; more than there is room for: the range is drawn in halves
    uint large_count;  // discs that asked for a place among the large
    uint queue_unused[2];
    uvec2 queue[];     // surfel's id, map
};
layout(std430, binding = 6) buffer Large { uint large_places[]; };  // in the queue

void queue_pair(uint id, uint map) {
    uint place = atomicAdd(queue_count, 1u);
    if (place < uint(queue.length())) queue[place] = uvec2(id, map);
}

// False where there is no room: then the disc is drawn at once, more slowly.
bool queue_large(uint place) {
    uint index = atomicAdd(large_count, 1u);
    if (index >= uint(large_places.length())) return false;
    large_places[index] = place;
    return true;
}
