// A decoded surfel of a cut with its footprint, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_FLAT_SURFEL_H
#define LUCARNE_GI_SHARED_FLAT_SURFEL_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_STRUCT(FlatSurfel) {
    float x, y, z;  // m, relative to the local origin
    float radius;   // m, of a whole disc, also where a line ends it; 0: no surfel has this id, or it is not
                    // drawn
    float area;     // m^2, its share of the surface
    uint normal;    // octahedral
    uint albedo;    // sRGB-coded, 10 bits each | flags << 30 (bit 30: has a normal)
    uint material;
    // Room for two edges, 16 bits each: half-planes in the tangent plane that clip the disc. kNoEdges: a
    // whole disc, as all are today.
    uint edges;
};
LUCARNE_CONST uint kNoEdges = 0xffffffffu;

#ifdef __cplusplus
static_assert(sizeof(FlatSurfel) == 36);
}  // namespace lucarne::gi
#endif
#endif
