// Lines at which the discs of surfels end, because their surface ends there, for C++, GLSL and OpenCL C.
// octree/tree/edge_line.h has the lines of a cache.
//
// A surfel with kSurfelHasEdge keeps its line in the lowest bits of its normal and its colour, which are
// finer than what scans know: the normal is off by at most .04 degrees, the colour by .3 % of white (sRGB).
// So whoever reads only these needs to know nothing of lines.
#ifndef LUCARNE_GI_SHARED_EDGE_H
#define LUCARNE_GI_SHARED_EDGE_H

#include "gi/shared/language.h"
#include "gi/shared/surfel.h"
#include "octree/tree/edge_turn.h"

#ifdef __cplusplus
namespace lucarne::gi {
using octree::turn_u, octree::turn_v;
#endif

// Steps of the direction around the point (a turn goes to 4), and of the distance in roots of the surfel's
// own share of the surface.
LUCARNE_CONST float kEdgeTurnSteps = 32.0f;
LUCARNE_CONST float kEdgeDistanceSteps = 32.0f;
LUCARNE_CONST uint kMostEdgeDistance = 127u;

// Returns the code of a line from words c and d of its surfel: distance | turn << 7. Bits 0 to 7 lie in the
// lowest four bits of the halves of c, bits 8 to 13 in the lowest two bits of the channels of d.
LUCARNE_FN uint surfel_edge_code(uint c, uint d) {
    return (c & 15u) | (c >> 12 & 240u) | (d & 3u) << 8 | (d & 0xc00u) | (d >> 8 & 0x3000u);
}

// Returns a line as toward / distance, 1/m: a point x of the plane is on the surfel's side if
// dot(edge, x - centre) <= 1. `normal`: of the surfel; `root`: of its own share of the surface, m. Zero, a
// line infinitely far away, if that is unknown.
LUCARNE_FN vec3 edge_of_code(uint code, vec3 normal, float root) {
    float turn = float(code >> 7) / kEdgeTurnSteps;
    float u = turn_u(turn);
    float v = turn_v(turn);
    vec3 size = abs(normal);
    // u and v are the components along the two axes after the one along which the normal is longest.
    vec3 toward = vec3(u, v, -(normal.x * u + normal.y * v) / normal.z);
    if (size.y >= size.z) toward = vec3(v, -(normal.z * u + normal.x * v) / normal.y, u);
    if (size.x >= size.y && size.x >= size.z) toward = vec3(-(normal.y * u + normal.z * v) / normal.x, u, v);
    float distance = float(code & kMostEdgeDistance) / kEdgeDistanceSteps * root;
    return distance > 0.0f ? toward * (inversesqrt(dot(toward, toward)) / distance) : vec3(0.0f);
}

// Returns whether an offset from a disc's centre, in its plane, is on the disc's side of its line.
LUCARNE_FN bool within_edge(vec3 edge, vec3 offset) {
    return dot(edge, offset) <= 1.0f;
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
