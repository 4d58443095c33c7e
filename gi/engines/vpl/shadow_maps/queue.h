// The queues between cull.comp, enqueue.comp, splat.comp and splat_large.comp, and the
// sizes that these shaders share with C++ (std430).
#ifndef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_QUEUE_H
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_QUEUE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

const uint kRunMaps = 256u;             // maps that a block is culled against at once
const uint kRunWords = kRunMaps / 32u;  // bits of a block's culling, in words
const uint kSplatGroup = 256u;          // pairs that a workgroup of splat.comp draws
const uint kLargeGroup = 16u;           // invocations that share a large disc in splat_large.comp
const uint kMostLargeGroups = 65535u;   // workgroups that OpenGL guarantees; they share the large discs
const uint kCasterWords = 4u;           // of a caster, casters.glsl
const uint kBoundsWords = 8u;           // of a block's bounds, queue.glsl

// One range of blocks and maps. Groups are what dispatch_indirect reads; plan.comp computes them.
struct SplatQueue {
    uint pair_groups[3];
    uint pair_count;  // pairs found; if they exceed the room, none is drawn
    uint large_groups[3];
    uint large_count;  // pairs too large for splat.comp; there is room for all pairs
};

#ifdef __cplusplus
static_assert(sizeof(SplatQueue) == 32);
}  // namespace lucarne::gi::vpl
#endif
#endif
