// Constants of merging interleaved tiles and of reusing the last frame's light, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADING_MERGING_H
#define LUCARNE_GI_ENGINES_VPL_SHADING_MERGING_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// Least weight of a candidate, of at most n^2 (join.glsl).
LUCARNE_CONST float kLeastCandidateWeight = 0.01f;

// A pixel of the last frame shows the surface of a point (history.glsl) if its normal differs by less than 25
// degrees (the cosine) and the point lies within a pixel's width of its plane.
LUCARNE_CONST float kSameNormal = 0.9f;
LUCARNE_CONST float kSamePlane = 1.0f;  // pixel widths
// Least sum of the bilinear weights of such pixels: a small weight of one pixel is too little evidence.
LUCARNE_CONST float kLeastEvidence = 0.05f;

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
