// Blends the queued large discs, a workgroup each.
#include "gi/raster/blend_large.glsl"
#include "gi/raster/queues.h"

layout(std430, binding = kBindQueues) readonly buffer Queues {
    QueueHeader queues;
    uint large_ids[];
};

void main() { blend_large(large_ids[gl_WorkGroupID.x]); }
