// Surfels as the devices hold them: structs shared by C++ and GLSL (std430), and what decodes them.
#ifndef LUCARNE_GI_SHARED_SURFEL_H
#define LUCARNE_GI_SHARED_SURFEL_H

#ifdef __cplusplus
#include <cstdint>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
namespace lucarne::gi {
using uint = uint32_t;
using vec3 = glm::vec3;
#endif

// 16 bytes a surfel.
//   a: x | y << 16           16-bit fractions of the node's cube
//   b: z | area << 16 | material << 24
//      area: own share at full resolution as s^2 * 2^(-code/8), s the node's size; 255: unknown (0)
//   c: normal, octahedral, two signed 16-bit fractions
//   d: albedo, sRGB-coded, 10 bits each | flags << 30 (bit 30: has a normal)
struct PackedSurfel {
    uint a, b, c, d;
};
const uint kSurfelHasNormal = 0x40000000u;

// One node of a cut. A surfel's position is origin + size * fraction; metres, relative to the frame's local
// origin.
struct CutItem {
    vec3 origin;
    float size;
    uint clip;   // place behind the items of the shapes that its surfels are tested against, see clip.h; 0:
                 // none
    uint count;  // prefix in use
    float area_floor;  // m^2, at that prefix
    uint inner;        // 1: some octant is to be looked up, 0: area_floor holds for all its surfels
    int child[8];      // the cut's item in each octant, or one of the two below
};
// The item's floor holds: its child there is not in the cut, or no more is known.
const int kCoarseOctant = -1;
// The source has no child there and the item is drawn whole: full resolution, floor 0.
const int kWholeOctant = -2;

// Surfels are processed in blocks of up to kBlockSurfels, each of one item.
// A surfel's id within a cut is block * kBlockSurfels + its place in the block: it depends on the cut alone,
// never on what else is resident, so that ties broken by id are the same on every run.
struct CutBlock {
    uint item;
    uint first;  // of its surfels in the pool
    uint count;
    uint lod;  // areas at its ends, see below
};
// What a surfel would stand for if no finer ones were drawn: the surface's share of each point when the
// levels of detail down to it are drawn, and its own node up to it. Along a block it falls from `lod &
// 0xffff` to `lod >> 16`, codes of an area of 2^(code / 512 - 64) m^2; its inverse, the density, rises
// evenly.
const uint kBlockSurfels = 256u;
const uint kNoSurfel = 0xffffffffu;

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
};
}  // namespace lucarne::gi
#endif
#endif
