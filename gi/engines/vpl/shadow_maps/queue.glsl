// The queues between meet.comp (culling), enter.comp (enqueueing), splat.comp and splat_large.comp.
#include "gi/engines/vpl/bindings.h"

layout(std430, binding = kBindQueue) buffer Queue {
    uint pair_count;   // pairs found; if they exceed the room, the range is drawn in halves
    uint large_count;  // pairs too large for splat.comp; there is room for all pairs
    uint queue_unused[2];
    uvec2 pairs[];     // id of the surfel, map
};
layout(std430, binding = kBindLarge) buffer Large { uint large_places[]; };    // indices into pairs[]
// kRunWords words a block; a bit is set unless the block is culled for that map of the run.
layout(std430, binding = kBindMeetings) buffer Meetings { uint meetings[]; };

const uint kRunWords = 8u;

// Bounds of a block: least position and largest lod_area of its casters; greatest position and largest radius.
layout(binding = kUnitBounds) uniform usamplerBuffer block_bounds;

