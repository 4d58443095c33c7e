// The one place where a surfel's size is decided, for C++ and GLSL alike (so: only what both languages share).
//
// In an additive octree the ancestors of a node stand among its own points, so a surfel's share of the surface
// follows from three things: its own share at full resolution (measured from its neighbours when the cache was
// built), the deepest node of the cut around it, and how long a prefix of that node is drawn. A node carries
// `floor`, the least share that makes the shares of all points in its cube (its own and its ancestors') add up
// to the surface there, for prefixes of 1, 1/2, 1/4 and 1/8.
#ifndef LUCARNE_OCTREE_FOOTPRINT_H
#define LUCARNE_OCTREE_FOOTPRINT_H

#ifdef __cplusplus
#include <cmath>
namespace lucarne::octree {
#define LUCARNE_SHARED_FN inline
#else
#define LUCARNE_SHARED_FN
#endif

// Disc area over surface share. A random pattern of coverage C leaves e^-C of the rays through (.00014 at 9), an
// even one far less: raw points get kCoverageRaw, points thinned to an even level of detail kCoverageEven.
const float kCoverageRaw = 9.0f;
const float kCoverageEven = 5.0f;

// The surfel's share of the surface, in the unit of its arguments. `own` is its share at full resolution (0 when
// unknown), `floor_area` the local floor at the prefix in use.
LUCARNE_SHARED_FN float surfel_area(float own, float floor_area) { return own > floor_area ? own : floor_area; }

// Disc radius for a share. Where the floor dominates, the pattern was thinned and is even; where the surfel's own
// share does, it is the raw scan's. Between them the coverage changes smoothly, so that no ring shows.
LUCARNE_SHARED_FN float surfel_radius(float own, float floor_area) {
    float area = surfel_area(own, floor_area);
    float rawness = floor_area > 0.0f ? own / floor_area : 1.0f;  // 0: thinned, >= 1: raw
    if (rawness > 1.0f) rawness = 1.0f;
    float coverage = kCoverageEven + (kCoverageRaw - kCoverageEven) * rawness;
#ifdef __cplusplus
    return std::sqrt(coverage * area * 0.31830989f);
#else
    return sqrt(coverage * area * 0.31830989);
#endif
}

#ifdef __cplusplus
// The floor at a prefix of `share` (0, 1] of a node's points, from its values at 1, 1/2, 1/4, 1/8: linear in the
// logarithms between them, inversely proportional below.
inline float floor_at_prefix(const float (&floors)[4], float share) {
    const float octaves = -std::log2(share > 0 ? share : 1e-6f);
    if (octaves >= 3) return floors[3] * std::exp2(octaves - 3);
    const int step = octaves > 0 ? static_cast<int>(octaves) : 0;
    const float t = octaves > 0 ? octaves - static_cast<float>(step) : 0.0f;
    if (floors[step] <= 0 || floors[step + 1 > 3 ? 3 : step + 1] <= 0) return floors[step];
    return step == 3 ? floors[3] : floors[step] * std::pow(floors[step + 1] / floors[step], t);
}
}  // namespace lucarne::octree
#endif
#undef LUCARNE_SHARED_FN
#endif
