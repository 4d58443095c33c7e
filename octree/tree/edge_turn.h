// Directions in a plane as one number, for C++, GLSL and OpenCL C alike. It uses only what these languages
// share.
//
// `turn` goes from 0 to 4 around the square |u| + |v| = 1: (1, 0) is 0, (0, 1) is 1, (-1, 0) is 2 and (0, -1)
// is 3. Unlike an angle it needs no sine, and multiples of 45 degrees are exact in a few bits.
#ifndef LUCARNE_OCTREE_EDGE_TURN_H
#define LUCARNE_OCTREE_EDGE_TURN_H

#ifdef __cplusplus
#include <cmath>
namespace lucarne::octree {
#define LUCARNE_TURN_FN inline
#define LUCARNE_TURN_ABS std::abs
#elif defined(__OPENCL_C_VERSION__)
#define LUCARNE_TURN_FN static inline
#define LUCARNE_TURN_ABS fabs
#else
#define LUCARNE_TURN_FN
#define LUCARNE_TURN_ABS abs
#endif

// Returns u and v of a turn from 0 to 4.
LUCARNE_TURN_FN float turn_u(float turn) {
    return LUCARNE_TURN_ABS(turn - 2.0f) - 1.0f;
}
LUCARNE_TURN_FN float turn_v(float turn) {
    return turn < 2.0f ? 1.0f - LUCARNE_TURN_ABS(turn - 1.0f) : LUCARNE_TURN_ABS(turn - 3.0f) - 1.0f;
}
// Returns the turn of a direction (u, v), not both 0; any length.
LUCARNE_TURN_FN float turn_of(float u, float v) {
    float along = u / (LUCARNE_TURN_ABS(u) + LUCARNE_TURN_ABS(v));
    return v < 0.0f ? 3.0f + along : 1.0f - along;
}

#ifdef __cplusplus
}  // namespace lucarne::octree
#endif
#undef LUCARNE_TURN_FN
#undef LUCARNE_TURN_ABS
#endif
