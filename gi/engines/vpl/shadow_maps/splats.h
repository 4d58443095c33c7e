// Sizes and tolerances of the splats of shadow maps, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_SPLATS_H
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_SPLATS_H

#include "gi/shared/brdf.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// Lower bound of the slant: discs seen edge-on grow by at most 1 over its root.
LUCARNE_CONST float kLeastSlant = 0.1f;
LUCARNE_CONST float kLargestSplat = 3.1623f;  // 1 / sqrt(kLeastSlant), in splat_angle * distance

// Number of splats over each direction where a map is thinned. At 3 even patterns leave 1 % open, holes of a
// texel that pull-push closes.
LUCARNE_CONST float kThinnedCover = 4.0f;
// Returns the area of a surface, m^2, that a splat stands for which sees it face on from a distance of 1 m.
LUCARNE_FN float thinned_area(float splat_angle) {
    return kPi / kThinnedCover * splat_angle * splat_angle;
}

// Radius of the core over that of the splat (fringe.glsl). With a cover of four, each direction lies in one
// core on average.
LUCARNE_CONST float kCore = 0.5f;

// How far the disc of a splat that grew to stand in for its neighbours may deviate from their surface, over
// its radius: .05 for a normal that is wrong by 3 degrees, .05 for a surface with a radius of curvature of
// ten times its radius.
LUCARNE_CONST float kSheetTolerance = 0.1f;

// A disc whose normal is within 60 degrees (the cosine) of the VPL's, and hardly above the centre of the map,
// is part of the VPL's own sheet.
LUCARNE_CONST float kOwnSheet = 0.5f;

// Tolerance for the sine of the angle between the coded normal of a texel and that of the surface: the code
// is mostly off by less than 2 degrees.
LUCARNE_CONST float kNormalError = 0.05f;

// The axes along which a fringe looks for cores on both sides (close.comp).
LUCARNE_CONST int kSupportAxes = 4;
LUCARNE_FN ivec2 support_axis(int i) {
    return ivec2(i == 1 ? 0 : 1, i == 0 ? 0 : (i == 3 ? -1 : 1));
}
// Texels that it looks at on each side.
LUCARNE_CONST int kSupportReach = 2;

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
