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
    uint seed;              // selects the rays and turns them about the normal
    LUCARNE_VEC3 viewer;    // unit direction to the viewer whose picture shows the point; zero: none
    float pad;
};

#ifdef __cplusplus
static_assert(sizeof(GatherPoint) == 48);
}  // namespace lucarne::gi
#endif
#endif
