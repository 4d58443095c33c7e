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
// Averages of frames are antialiased by rays that do not pass through the middles of their pixels: right.w
// and up.w are added to x and y, so they move all rays to the right and down by these parts of a pixel.
LUCARNE_CONST uint kPerspective = 0u, kOrthographic = 1u;

LUCARNE_STRUCT(CameraView) {
    vec4 origin;   // xyz: metres, relative to the local origin; w: near plane (m)
    vec4 forward;  // unit
    vec4 right;    // unit * tan(half horizontal field), or half the width; w: shift to the right, pixels
    vec4 up;       // unit * tan(half vertical field), or half the height; w: shift down, pixels
    uint width, height, projection, pad0;
#ifdef __cplusplus
    bool operator==(const CameraView&) const = default;
#endif
};

// Returns where the ray through the picture point `at` (pixels, middles of pixels at .5) crosses the plane of
// the picture, along `right` and -`up`, -1 to 1 from edge to edge.
LUCARNE_FN vec2 view_ndc(CameraView view, vec2 at) {
    vec2 shifted = at + vec2(view.right.w, view.up.w);
    return 2.0f * shifted / vec2(float(view.width), float(view.height)) - 1.0f;
}
// Returns the picture point of a ray, the inverse of view_ndc().
LUCARNE_FN vec2 view_pixel(CameraView view, vec2 ndc) {
    vec2 shifted = (0.5f * ndc + 0.5f) * vec2(float(view.width), float(view.height));
    return shifted - vec2(view.right.w, view.up.w);
}

LUCARNE_FN bool is_parallel(CameraView view) {
    return view.projection == kOrthographic;
}
// Returns the offset of the picture point `at` from the middle of the picture, along `right` and `up`.
LUCARNE_FN vec3 view_across(CameraView view, vec2 at) {
    vec2 ndc = view_ndc(view, at);
    return xyz_of(view.right) * ndc.x - xyz_of(view.up) * ndc.y;
}
// Returns the ray through the picture point `at`, scaled so that dot(ray, forward) = 1.
LUCARNE_FN vec3 view_ray(CameraView view, vec2 at) {
    return xyz_of(view.forward) + (is_parallel(view) ? vec3(0.0f) : view_across(view, at));
}
LUCARNE_FN vec3 view_start(CameraView view, vec2 at) {
    return xyz_of(view.origin) + (is_parallel(view) ? view_across(view, at) : vec3(0.0f));
}
// Returns the point that `at` shows at a depth.
LUCARNE_FN vec3 view_point(CameraView view, vec2 at, float depth) {
    return view_start(view, at) + depth * view_ray(view, at);
}
// The same relative to the origin of the view, for callers that add the two with more precision.
LUCARNE_FN vec3 view_offset(CameraView view, vec2 at, float depth) {
    return (is_parallel(view) ? view_across(view, at) : vec3(0.0f)) + depth * view_ray(view, at);
}
// Projects a point: returns its picture point, and sets `depth` to its depth along the forward axis, m.
LUCARNE_FN vec2 view_place(CameraView view, vec3 position, LUCARNE_OUT(float) depth) {
    vec3 offset = position - xyz_of(view.origin);
    vec3 right = xyz_of(view.right), up = xyz_of(view.up);
    LUCARNE_VALUE(depth) = dot(offset, xyz_of(view.forward));
    vec2 ndc = vec2(dot(offset, right) / dot(right, right), -dot(offset, up) / dot(up, up));
    if (!is_parallel(view)) ndc /= LUCARNE_VALUE(depth);
    return view_pixel(view, ndc);
}
// Returns the height of a pixel at a depth, m.
LUCARNE_FN float pixel_height(CameraView view, float depth) {
    return 2.0f * length(xyz_of(view.up)) / float(view.height) * (is_parallel(view) ? 1.0f : depth);
}
// Returns the unit direction from a point to the viewer.
LUCARNE_FN vec3 toward_viewer(CameraView view, vec3 position) {
    return is_parallel(view) ? -xyz_of(view.forward) : normalize(xyz_of(view.origin) - position);
}

#ifdef __cplusplus
static_assert(sizeof(CameraView) == 80);
}  // namespace lucarne::gi
#endif
#endif
