// The buffers of queue.h.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/queue.h"

layout(std430, binding = kBindQueues) buffer Queues { SplatQueue queues[]; };
uniform uint queue;  // the range that is drawn
layout(std430, binding = kBindPairs) buffer Pairs { uvec2 pairs[]; };       // id of the surfel, map
layout(std430, binding = kBindLarge) buffer Large { uint large_places[]; };  // indices into pairs[]
// kRunWords words a block; a bit is set unless the block is culled for that map of the run.
layout(std430, binding = kBindMeetings) buffer Meetings { uint meetings[]; };

// Bounds of a block: least position and largest lod_area of its casters; greatest position and largest radius.
layout(binding = kUnitBounds) uniform usamplerBuffer block_bounds;
