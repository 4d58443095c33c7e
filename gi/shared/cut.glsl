// The surfels of a cut: bindings 0 to 2, which DeviceCut::bind sets, and what reads them.
#include "octree/footprint.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"

layout(std430, binding = 0) readonly buffer CutPool { PackedSurfel cut_pool[]; };
layout(std430, binding = 1) readonly buffer CutItems { CutItem cut_items[]; };
layout(std430, binding = 2) readonly buffer CutBlocks { uvec2 cut_blocks[]; };

// Finds surfel `id` of the cut; false where the id lies in the gap behind a node's last surfel. Workgroups of
// kBlockSurfels invocations, one a block, meet one item each.
bool cut_surfel(uint id, out uint item, out PackedSurfel surfel) {
    uvec2 block = cut_blocks[id / kBlockSurfels];
    uint place = block.y + id % kBlockSurfels;
    item = block.x;
    if (place >= cut_items[item].count) return false;
    surfel = cut_pool[cut_items[item].first + place];
    return true;
}

// Metres, relative to the local origin.
vec3 surfel_position(uint item, PackedSurfel surfel) {
    return cut_items[item].origin + cut_items[item].size * surfel_fractions(surfel.a, surfel.b);
}

bool surfel_has_normal(PackedSurfel surfel) { return (surfel.d & kSurfelHasNormal) != 0u; }
vec3 surfel_normal(PackedSurfel surfel) { return decode_octahedral(surfel.c); }

// The floor of the deepest item of the cut around the surfel: only surfels of ancestors look further than once.
float surfel_area_floor(uint item, PackedSurfel surfel) {
    for (uint depth = 0u; depth < kOctantLevels; ++depth) {
        int child = cut_items[item].child[surfel_octant(surfel.a, surfel.b, depth)];
        if (child < 0) break;
        item = uint(child);
    }
    return cut_items[item].area_floor;
}

// Disc radius (m) and share of the surface (m^2).
float cut_surfel_radius(uint item, PackedSurfel surfel) {
    return surfel_radius(surfel_own_area(surfel.b, cut_items[item].size), surfel_area_floor(item, surfel));
}
float cut_surfel_area(uint item, PackedSurfel surfel) {
    return surfel_area(surfel_own_area(surfel.b, cut_items[item].size), surfel_area_floor(item, surfel));
}
