// A place where light is gathered, for C++ and OpenCL C.
#ifndef LUCARNE_GI_GATHER_GATHER_POINT_H
#define LUCARNE_GI_GATHER_GATHER_POINT_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_STRUCT(GatherPoint) {
    LUCARNE_VEC3 position;  // of the surface, m
    float lift;             // rays start this far above it, m
    LUCARNE_VEC3 normal;    // unit, on the side that gathers
    uint seed;              // selects the rays and turns them about the axis
    LUCARNE_VEC3 viewer;    // unit direction to the viewer whose picture shows the point; zero: none
    float exponent;         // 0: all light counts alike; else see below
    LUCARNE_VEC3 axis;      // unit, the middle of the micro-buffer: the normal, or the mirror direction
    float scale;            // sine of the largest angle to the axis: 1 for a half space
};
// A point with an exponent n gathers for a specular lobe about its axis: light from the direction w
// counts (w . axis)^(n - 1) (w . normal). Rays are drawn with the density (w . axis) / (pi scale^2), so
// the lobe ks (n + 2) / (2 pi) (w . axis)^n reflects ks (n + 2) / 2 scale^2 times the mean.

// What a pixel of a micro-buffer sees, if it is no side of a slot.
LUCARNE_CONST uint kSeesNothing = 0xffffffffu;  // it has no ray
LUCARNE_CONST uint kSeesSky = 0xfffffffeu;

#ifdef __cplusplus
static_assert(sizeof(GatherPoint) == 64);
}  // namespace lucarne::gi
#endif
#endif
