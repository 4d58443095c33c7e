// A pinhole or orthographic camera (or a light's view, a pinhole) for C++, GLSL (std140 and std430) and
// OpenCL C.
#ifndef LUCARNE_GI_SHARED_CAMERA_H
#define LUCARNE_GI_SHARED_CAMERA_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// The ray through pixel (x, y), row 0 on top, has the direction
//   d = forward + right * (2 (x + .5) / width - 1) - up * (2 (y + .5) / height - 1)
// It is scaled so that dot(d, forward) = 1: the point at a depth along forward is origin + depth * d.
// `right` and `up` carry the tangents of half the field of view. In an orthographic view all rays have the
// direction `forward`, and the ray through (x, y) starts at
//   origin + right * (2 (x + .5) / width - 1) - up * (2 (y + .5) / height - 1);
// There `right` and `up` carry half the width and half the height of the view, m.
LUCARNE_CONST uint kPerspective = 0u, kOrthographic = 1u;

LUCARNE_STRUCT(CameraView) {
    vec4 origin;   // xyz: metres, relative to the local origin; w: near plane (m)
    vec4 forward;  // unit
    vec4 right;    // unit * tan(half horizontal field), or half the width
    vec4 up;       // unit * tan(half vertical field), or half the height
    uint width, height, projection, pad0;
#ifdef __cplusplus
    bool operator==(const CameraView&) const = default;
#endif
};

#ifdef __cplusplus
static_assert(sizeof(CameraView) == 80);
}  // namespace lucarne::gi
#endif
#endif
