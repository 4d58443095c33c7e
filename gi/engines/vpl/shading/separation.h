// Which points may belong to one surface, and so do not light each other, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADING_SEPARATION_H
#define LUCARNE_GI_ENGINES_VPL_SHADING_SEPARATION_H

#include "gi/shared/gbuffer.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// Points of one plane do not light each other, whichever side they face: positions are rounded, and the
// G-buffer lets the rim of a disc stick out of the surface that hides it by a share of its radius (kRimPush).
// Otherwise a lamp on a roof would light the ceiling under it. Neither do points that see each other at very
// low angles: noise tilts the normals of a scanned floor by some degrees, and two points that happen to lean
// toward each other would exchange light over many metres (README.md has figures). Where both face each other
// they may also be the two sides of a thin sheet, such as a ceiling in the sun: only points that stand clear
// of each other count.
//
// The height of either over the plane of the other, in radii, from which light counts, and the range over
// which it comes to count whole; the second of each pair is for points that face each other.
LUCARNE_CONST float kClear = kRimPush, kClearFacing = 2.0f;
LUCARNE_CONST float kClearRange = 0.6f - kRimPush, kClearRangeFacing = 2.0f;
// The same for the sine of the larger angle over the horizon.
LUCARNE_CONST float kRise = 0.035f, kRiseFacing = 0.1f;
LUCARNE_CONST float kRiseRange = 0.07f, kRiseRangeFacing = 0.1f;

// Returns the share, from 0 to 1, of the light between two points that counts. `heights` are those of each
// over the plane of the other, m; `cosine` is that between their normals.
LUCARNE_FN float separate_share(vec2 heights, float distance_m, float radius, float cosine) {
    float opposite = clamp(-cosine, 0.0f, 1.0f);
    float clearance = min(heights.x, heights.y) / radius;
    float rise = max(heights.x, heights.y) / distance_m;
    return clamp((clearance - mix(kClear, kClearFacing, opposite)) /
                     mix(kClearRange, kClearRangeFacing, opposite),
                 0.0f, 1.0f) *
           clamp((rise - mix(kRise, kRiseFacing, opposite)) / mix(kRiseRange, kRiseRangeFacing, opposite),
                 0.0f, 1.0f);
}

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
