// What meet.comp, enter.comp, splat.comp and splat_large.comp hand on to each other.
layout(std430, binding = 11) buffer Queue {
    uint pair_count;   // that asked for a place; more than there is room for: the range is drawn in halves
    uint large_count;  // of them too large for splat.comp; as many places as pairs
    uint queue_unused[2];
    uvec2 pairs[];     // surfel's id, map
};
layout(std430, binding = 6) buffer Large { uint large_places[]; };    // of pairs
layout(std430, binding = 7) buffer Meetings { uint meetings[]; };     // kRunWords a block, a bit a map of the run

const uint kRunWords = 8u;

// A block's bounds: least position and largest lod_area of its casters; greatest position and largest radius.
layout(binding = 7) uniform usamplerBuffer block_bounds;

