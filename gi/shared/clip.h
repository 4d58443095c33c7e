// Shapes that points are clipped by, and the test of a point, for C++ and GLSL alike.
#ifndef LUCARNE_GI_SHARED_CLIP_H
#define LUCARNE_GI_SHARED_CLIP_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Metres, relative to the local origin. The first of several also says how many they are.
struct ClipShape {
    vec4 axis[3];  // a box is where |dot(axis.xyz, p) + axis.w| <= 1 for all three
    vec4 kind;     // x: one of the three below; y: how many shapes there are
};
const float kClipInside = 0.0f;   // kept are the points in any of these boxes
const float kClipOutside = 1.0f;  // and in none of these
const float kClipPlane = 2.0f;    // and with dot(axis[0].xyz, p) + axis[0].w >= 0

// What the shapes so far say of a point: shapes are folded into it one by one, in any order.
const uint kClipUntold = 0u;
const uint kClipInNone = 1u;  // of the boxes that keep what is inside
const uint kClipInOne = 2u;
const uint kClipGone = 3u;
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
static_assert(sizeof(ClipShape) == 64);  // as large as a CutItem, behind which shaders find it
}  // namespace lucarne::gi
#endif
#endif
