// Defines the size of a surfel, for C++, GLSL and OpenCL C alike. It uses only what these languages share.
//
// In an additive octree the points of a node's ancestors lie among its own. So a surfel's share of the
// surface follows from three things: its own share at full resolution (measured from its neighbours when the
// cache was built), the deepest node of the cut around it, and how long a prefix of that node is drawn. A
// node carries `floor`: the least share with which the shares of all points in its cube (its own and its
// ancestors') add up to the surface there. It is stored for prefixes of 1, 1/2, 1/4 and 1/8.
#ifndef LUCARNE_OCTREE_FOOTPRINT_H
#define LUCARNE_OCTREE_FOOTPRINT_H

#ifdef __cplusplus
#include <cmath>
namespace lucarne::octree {
#define LUCARNE_SHARED_FN inline
#define LUCARNE_SHARED_CONST const
#elif defined(__OPENCL_C_VERSION__)
#define LUCARNE_SHARED_FN static inline
#define LUCARNE_SHARED_CONST __constant
#else
#define LUCARNE_SHARED_FN
#define LUCARNE_SHARED_CONST const
#endif

// Coverage: disc area divided by surface share. In a random pattern, discs of equal size let e^-C of the rays
// through (.0002 at a coverage C of 9). Discs that follow each point's own share do as well at 7, and an even
// pattern needs still less; octree/normals/README.md has the measurements. So points with a share of their
// own get kCoverageRaw, points thinned to an even level of detail kCoverageEven, and points whose own share
// was not measured kCoverageUnknown.
LUCARNE_SHARED_CONST float kCoverageRaw = 7.0f;
LUCARNE_SHARED_CONST float kCoverageEven = 5.0f;
LUCARNE_SHARED_CONST float kCoverageUnknown = 9.0f;

// Returns the surfel's share of the surface, in the unit of the arguments. `own` is its share at full
// resolution (0 when unknown), `floor_area` the local floor at the prefix in use.
LUCARNE_SHARED_FN float surfel_area(float own, float floor_area) {
    return own > floor_area ? own : floor_area;
}

// Returns the disc radius for a share. Where the floor dominates, the pattern was thinned and is even. Where
// the surfel's own share dominates, the pattern is that of the raw scan. The coverage changes smoothly in
// between, so that no ring shows.
LUCARNE_SHARED_FN float surfel_radius(float own, float floor_area) {
    float area = surfel_area(own, floor_area);
    float rawness = own < floor_area ? own / floor_area : 1.0f;  // 0: thinned, 1: raw
    float coverage = own > 0.0f ? kCoverageEven + (kCoverageRaw - kCoverageEven) * rawness : kCoverageUnknown;
#ifdef __cplusplus
    using std::sqrt;
#endif
    return sqrt(coverage * area * 0.31830989f);
}

#ifdef __cplusplus
// Returns the floor at a prefix of `share` (0, 1] of a node's points, from its values at 1, 1/2, 1/4, 1/8. It
// is linear in the logarithms between them and inversely proportional to the share below 1/8. Where the full
// prefix needs almost no floor, because the points' own shares fill the surface (a first value near 0),
// leaving points out raises the floor to about the mean share at once. The second term models this jump. It
// was measured on random and even patterns and keeps the sum of all areas within a twelfth of the surface.
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
#undef LUCARNE_SHARED_CONST
#endif
