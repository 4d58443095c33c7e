// A decoded surfel of a cut with its footprint, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_FLAT_SURFEL_H
#define LUCARNE_GI_SHARED_FLAT_SURFEL_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_STRUCT(FlatSurfel) {
    float x, y, z;  // m, relative to the local origin
    float radius;   // m; 0: no surfel has this id, or it is not drawn. Where a line ends the disc, it is that
                    // of passes that draw it round (cut.glsl)
    float area;     // m^2, its share of the surface
    uint normal;    // octahedral
    uint albedo;    // sRGB-coded, 10 bits each | flags << 30 (bit 30: has a normal)
    uint material;
    float edge_root;  // the root of its own share, m, with which `normal` and `albedo` hold the line at which
                      // the disc ends (edge.h); 0: a whole disc
};

#ifdef __cplusplus
static_assert(sizeof(FlatSurfel) == 36);
}  // namespace lucarne::gi
#endif
#endif
