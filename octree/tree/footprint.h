// The one place where a surfel's size is decided, for C++ and GLSL alike (so: only what both languages
// share).
//
// In an additive octree the ancestors of a node stand among its own points, so a surfel's share of the
// surface follows from three things: its own share at full resolution (measured from its neighbours when the
// cache was built), the deepest node of the cut around it, and how long a prefix of that node is drawn. A
// node carries `floor`, the least share that makes the shares of all points in its cube (its own and its
// ancestors') add up to the surface there, for prefixes of 1, 1/2, 1/4 and 1/8.
#ifndef LUCARNE_OCTREE_FOOTPRINT_H
#define LUCARNE_OCTREE_FOOTPRINT_H

#ifdef __cplusplus
#include <cmath>
namespace lucarne::octree {
#define LUCARNE_SHARED_FN inline
#else
#define LUCARNE_SHARED_FN
#endif

// Disc area over surface share. Discs of equal size leave e^-C of the rays through a random pattern (.0002 at
// 9); discs that follow each point's own share do as well with 7, and an even pattern needs less still:
// measured, see README.md beside this file. So points with a share of their own get kCoverageRaw, points
// thinned to an even level of detail kCoverageEven, and points whose own share nobody has measured
// kCoverageUnknown.
const float kCoverageRaw = 7.0f;
const float kCoverageEven = 5.0f;
const float kCoverageUnknown = 9.0f;

// The surfel's share of the surface, in the unit of its arguments. `own` is its share at full resolution (0
// when unknown), `floor_area` the local floor at the prefix in use.
LUCARNE_SHARED_FN float surfel_area(float own, float floor_area) {
    return own > floor_area ? own : floor_area;
}

// Disc radius for a share. Where the floor dominates, the pattern was thinned and is even; where the surfel's
// own share does, it is the raw scan's. Between them the coverage changes smoothly, so that no ring shows.
LUCARNE_SHARED_FN float surfel_radius(float own, float floor_area) {
    float area = surfel_area(own, floor_area);
    float rawness = own < floor_area ? own / floor_area : 1.0f;  // 0: thinned, 1: raw
    float coverage = own > 0.0f ? kCoverageEven + (kCoverageRaw - kCoverageEven) * rawness : kCoverageUnknown;
#ifdef __cplusplus
    return std::sqrt(coverage * area * 0.31830989f);
#else
    return sqrt(coverage * area * 0.31830989);
#endif
}

#ifdef __cplusplus
// The floor at a prefix of `share` (0, 1] of a node's points, from its values at 1, 1/2, 1/4, 1/8: linear in
// the logarithms between them, inversely proportional below. Where points are left out whose own shares
// filled the surface (a first value near 0), the floor jumps to about the mean share at once: the second
// term, measured on random and even patterns, keeps the sum of all areas within a twelfth of the surface.
inline float floor_at_prefix(const float (&floors)[4], float share) {
    const float octaves = -std::log2(share > 1e-6f ? share : 1e-6f);
    if (!(octaves > 0)) return floors[0];
    if (octaves >= 3) return floors[3] * std::exp2(octaves - 3);
    const int step = static_cast<int>(octaves);
    const float t = octaves - static_cast<float>(step), a = floors[step], b = floors[step + 1];
    const float even = a > 0 && b > 0 ? a * std::pow(b / a, t) : 0;
    const float jump = b * std::exp2(t - 1) * (1 - std::pow(1 - t, 10.0f));
    return even > jump ? even : jump;
}
}  // namespace lucarne::octree
#endif
#undef LUCARNE_SHARED_FN
#endif
