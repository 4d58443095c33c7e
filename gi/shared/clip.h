// Clip shapes and the test of a point against them, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_CLIP_H
#define LUCARNE_GI_SHARED_CLIP_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// One clip shape, in metres relative to the local origin. The first shape of a list also holds the number of
// shapes.
LUCARNE_STRUCT(ClipShape) {
    vec4 axis[3];  // a box: |dot(axis.xyz, p) + axis.w| <= 1 for all three
    vec4 kind;     // x: one of the three kinds below; y: number of shapes (first shape only)
};
LUCARNE_CONST float kClipInside = 0.0f;   // keeps the points inside any box of this kind
LUCARNE_CONST float kClipOutside = 1.0f;  // removes the points inside a box of this kind
LUCARNE_CONST float kClipPlane = 2.0f;    // keeps the points with dot(axis[0].xyz, p) + axis[0].w >= 0

// State of a point after some shapes have been tested. Shapes are folded in one by one, in any order.
LUCARNE_CONST uint kClipUntold = 0u;  // not removed, and no kClipInside box so far
LUCARNE_CONST uint kClipInNone = 1u;  // outside every kClipInside box so far
LUCARNE_CONST uint kClipInOne = 2u;   // inside one of them
LUCARNE_CONST uint kClipGone = 3u;    // removed
LUCARNE_FN bool clip_kept(uint known) {
    return known == kClipUntold || known == kClipInOne;
}

LUCARNE_FN float clip_place(vec3 p, vec4 axis) {
    return dot(vec3(axis.x, axis.y, axis.z), p) + axis.w;
}
LUCARNE_FN uint clip_fold(uint known, vec3 p, vec4 x, vec4 y, vec4 z, float kind) {
    float along = clip_place(p, x);
    if (kind == kClipPlane) return along >= 0.0f ? known : kClipGone;
    bool in_box = max(max(abs(along), abs(clip_place(p, y))), abs(clip_place(p, z))) <= 1.0f;
    if (kind == kClipOutside) return in_box ? kClipGone : known;
    if (known == kClipGone) return known;
    return in_box ? kClipInOne : max(known, kClipInNone);
}

#ifdef __cplusplus
static_assert(sizeof(ClipShape) == 64);  // the size of a CutItem: shapes follow the items in one buffer
}  // namespace lucarne::gi
#endif
#endif
