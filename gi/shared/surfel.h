// Surfels and cuts as devices store them: structs for C++, GLSL (std430) and OpenCL C. surfel_code.h encodes
// and decodes them.
#ifndef LUCARNE_GI_SHARED_SURFEL_H
#define LUCARNE_GI_SHARED_SURFEL_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// 16 bytes a surfel.
//   a: x | y << 16           16-bit fractions of the node's cube
//   b: z | area << 16 | material << 24
//      area: own share at full resolution as s^2 * 2^(-code/8), s the node's size; 255: unknown (0);
//      254 without a normal: an outlier (kStrayArea)
//   c: normal, octahedral, two signed 16-bit fractions
//   d: albedo, sRGB-coded, 10 bits each | flags << 30 (bit 30: has a normal; bit 31: has a line, see edge.h)
LUCARNE_STRUCT(PackedSurfel) {
    uint a, b, c, d;
};
LUCARNE_CONST uint kSurfelHasNormal = 0x40000000u;
LUCARNE_CONST uint kSurfelHasEdge = 0x80000000u;

// One node of a cut. A surfel's position is origin + size * fraction; metres, relative to the frame's local
// origin.
LUCARNE_STRUCT(CutItem) {
    LUCARNE_VEC3 origin;
    float size;
    uint clip;   // index of the first ClipShape, counted in items: shapes follow the items; 0: no clip test
    uint count;  // prefix in use
    float area_floor;  // m^2, at that prefix
    uint inner;        // 1: child[] has to be looked up; 0: area_floor holds for all its surfels
    int child[8];      // index of the item in each octant, or one of the two constants below
};
// In this octant the item's own floor holds: its child is not in the cut, or nothing more is known.
LUCARNE_CONST int kCoarseOctant = -1;
// The source has no child in this octant and the item is drawn whole: full resolution, so the floor is 0.
LUCARNE_CONST int kWholeOctant = -2;

// Surfels are processed in blocks of up to kBlockSurfels; the surfels of a block belong to one item.
// A surfel's id within a cut is block * kBlockSurfels + its place in the block. The id depends on the cut
// alone, never on what else is resident, so ties broken by id are broken alike on every run.
LUCARNE_STRUCT(CutBlock) {
    uint item;
    uint first;  // index of its first surfel in the pool
    uint count;
    uint lod;  // codes of the areas at both ends, see below
};
// CutBlock.lod codes the area that a surfel stands for if no finer surfels are drawn: its share of the
// surface when the levels of detail above it, and its own node up to it, are drawn. Along a block this area
// falls from code `lod & 0xffff` to code `lod >> 16`; its inverse, the density, rises linearly. A code
// stands for 2^(code / 512 - 64) m^2.
LUCARNE_CONST uint kBlockSurfels = 256u;
LUCARNE_CONST uint kNoSurfel = 0xffffffffu;

#ifdef __cplusplus
static_assert(sizeof(PackedSurfel) == 16 && sizeof(CutItem) == 64 && sizeof(CutBlock) == 16);

/// A surfel as the host sees it (the reference engine, tests).
struct Surfel {
    glm::vec3 position;  ///< metres, relative to the local origin
    glm::vec3 normal;    ///< unit; zero where the point has none
    glm::vec3 albedo;    ///< linear Rec. 709, before the material's scale
    float radius;        ///< m
    float area;          ///< m^2
    uint32_t material;
    /// The line at which its disc ends (gi/shared/edge.h), 1/m; zero: none.
    glm::vec3 edge{0.0f};
};
}  // namespace lucarne::gi
#endif
#endif
