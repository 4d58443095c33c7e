// Maps a direction to a place in the picture of an environment, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_ENVIRONMENT_H
#define LUCARNE_GI_SHARED_ENVIRONMENT_H

#include "gi/shared/language.h"

#ifdef __cplusplus
#include <glm/trigonometric.hpp>
namespace lucarne::gi {
using glm::acos, glm::atan, glm::fract;
#endif

// OpenCL C calls the angle atan2, and its fract takes another argument.
#ifdef __OPENCL_C_VERSION__
LUCARNE_FN float environment_angle(float y, float x) {
    return atan2(y, x);
}
LUCARNE_FN float environment_fraction(float x) {
    return x - floor(x);
}
#else
LUCARNE_FN float environment_angle(float y, float x) {
    return atan(y, x);
}
LUCARNE_FN float environment_fraction(float x) {
    return fract(x);
}
#endif

// Returns where the unit direction lies in an equirectangular picture, both coordinates in [0, 1) from the
// upper left corner. The zenith (+z) is on top, +y in the middle, +x to the right of it. `rotation` turns
// the picture about z, in radians, counterclockwise seen from above.
LUCARNE_FN vec2 environment_place(vec3 direction, float rotation) {
    float turns =
        direction.x == 0.0f && direction.y == 0.0f ? 0.0f : environment_angle(direction.x, direction.y);
    float u = environment_fraction(0.5f + (turns + rotation) / 6.28318531f);
    float v = acos(clamp(direction.z, -1.0f, 1.0f)) / 3.14159265f;
    return vec2(min(u, 0.99999994f), min(v, 0.99999994f));
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
