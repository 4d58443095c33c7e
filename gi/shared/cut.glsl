// Access to the surfels of a cut. DeviceCut::bind binds pool, items and blocks as texels of four words;
// Buffer::bind_texels says why.
#include "gi/shared/cut_bindings.h"
#include "octree/tree/footprint.h"
#include "gi/shared/clip.h"
#include "gi/shared/edge.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"

layout(binding = kUnitCutPool) uniform usamplerBuffer cut_pool;    // PackedSurfel
// CutItem: (origin, size), (clip, count, area_floor, inner), children, children; the ClipShapes follow the items.
layout(binding = kUnitCutItems) uniform usamplerBuffer cut_items;
layout(binding = kUnitCutBlocks) uniform usamplerBuffer cut_blocks;  // CutBlock

// Returns the cube of the item: xyz its origin, w its side (m).
vec4 cut_item_cube(uint item) { return uintBitsToFloat(texelFetch(cut_items, int(4u * item))); }

// Returns the position of the surfel, metres, relative to the local origin.
vec3 surfel_position(uint item, PackedSurfel surfel) {
    vec4 cube = cut_item_cube(item);
    return cube.xyz + cube.w * surfel_fractions(surfel.a, surfel.b);
}

// Returns whether the clip shapes of the item keep the surfel.
bool surfel_kept(uint item, PackedSurfel surfel) {
    int at = 4 * int(texelFetch(cut_items, int(4u * item + 1u)).x);
    if (at == 0) return true;
    vec3 p = surfel_position(item, surfel);
    vec4 kind = uintBitsToFloat(texelFetch(cut_items, at + 3));
    int end = at + 4 * int(kind.y);
    uint known = kClipUntold;
    for (; at < end; at += 4) {
        kind = uintBitsToFloat(texelFetch(cut_items, at + 3));
        known = clip_fold(known, p, uintBitsToFloat(texelFetch(cut_items, at)),
                          uintBitsToFloat(texelFetch(cut_items, at + 1)),
                          uintBitsToFloat(texelFetch(cut_items, at + 2)), kind.x);
    }
    return clip_kept(known);
}

// Finds surfel `id` of the cut. Returns false if the id lies in the gap behind the last surfel of a block, or if the
// surfel is clipped. A workgroup of kBlockSurfels invocations covers one block and therefore reads one item.
bool cut_surfel(uint id, out uint item, out PackedSurfel surfel) {
    uvec4 block = texelFetch(cut_blocks, int(id / kBlockSurfels));
    uint place = id % kBlockSurfels;
    item = block.x;
    if (place >= block.z) return false;
    uvec4 words = texelFetch(cut_pool, int(block.y + place));
    surfel = PackedSurfel(words.x, words.y, words.z, words.w);
    return surfel_kept(item, surfel);
}

// Level-of-detail areas (m^2) as CutBlock describes them: of a code, and of a surfel by its place in its block.
float lod_area(uint code) { return exp2(float(code) / 512.0 - 64.0); }
float surfel_lod_area(uint id) {
    uvec4 block = texelFetch(cut_blocks, int(id / kBlockSurfels));
    float along = (float(id % kBlockSurfels) + 0.5) / float(max(block.z, 1u));
    return 1.0 / mix(1.0 / lod_area(block.w & 0xffffu), 1.0 / lod_area(block.w >> 16), min(along, 1.0));
}

bool surfel_has_normal(PackedSurfel surfel) { return (surfel.d & kSurfelHasNormal) != 0u; }
vec3 surfel_normal(PackedSurfel surfel) { return decode_octahedral(surfel.c); }
// Returns the line at which the surfel's disc ends (edge.h).
vec3 surfel_edge(uint item, PackedSurfel surfel) {
    if ((surfel.d & kSurfelHasEdge) == 0u) return vec3(0.0);
    return edge_of_code(surfel_edge_code(surfel.c, surfel.d), surfel_normal(surfel),
                        sqrt(surfel_own_area(surfel.b, cut_item_cube(item).w)));
}

// Returns the area floor of the deepest item of the cut around the surfel. Only surfels of ancestors take more than
// one step. In an octant where the source has no child the floor is 0; otherwise an outlier there would be drawn as
// large as the spacing of the other points of its node.
float surfel_area_floor(uint item, PackedSurfel surfel) {
    uvec4 facts = texelFetch(cut_items, int(4u * item + 1u));
    for (uint depth = 0u; facts.w != 0u && depth < kOctantLevels; ++depth) {
        uint octant = surfel_octant(surfel.a, surfel.b, depth);
        uvec4 children = texelFetch(cut_items, int(4u * item + 2u + (octant >> 2)));
        int child = int(children[octant & 3u]);
        if (child == kWholeOctant) return 0.0;
        if (child < 0) break;
        item = uint(child);
        facts = texelFetch(cut_items, int(4u * item + 1u));
    }
    return uintBitsToFloat(facts.z);
}

// Return the disc radius (m) and the share of the surface (m^2). Both are 0 for an outlier (surfel_is_stray).
float cut_surfel_radius(uint item, PackedSurfel surfel) {
    if (surfel_is_stray(surfel.b, surfel.d)) return 0.0;
    return surfel_radius(surfel_own_area(surfel.b, cut_item_cube(item).w), surfel_area_floor(item, surfel));
}
// Returns the radius of the disc in passes that draw it round: at full resolution it reaches about half a spacing over
// its line. It should not shade what lies beyond an edge, but has to be closed where it meets the other side.
float cut_surfel_round_radius(uint item, PackedSurfel surfel) {
    if (surfel_is_stray(surfel.b, surfel.d)) return 0.0;
    const float over_line = 0.4;  // roots of the surfel's own share; the line itself stands .1 spacings outside
    float own = surfel_own_area(surfel.b, cut_item_cube(item).w);
    vec3 edge = surfel_edge(item, surfel);
    if (edge != vec3(0.0)) {
        float reach = inversesqrt(dot(edge, edge)) + over_line * sqrt(own);
        own = min(own, 3.14159265 / kCoverageRaw * reach * reach);
    }
    return surfel_radius(own, surfel_area_floor(item, surfel));
}
float cut_surfel_area(uint item, PackedSurfel surfel) {
    if (surfel_is_stray(surfel.b, surfel.d)) return 0.0;
    return surfel_area(surfel_own_area(surfel.b, cut_item_cube(item).w), surfel_area_floor(item, surfel));
}
