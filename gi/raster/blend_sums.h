// The sums from which a pixel's blended texel follows, shared by C++ and GLSL.
#ifndef LUCARNE_GI_RASTER_BLEND_SUMS_H
#define LUCARNE_GI_RASTER_BLEND_SUMS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::raster {
#endif

// Words a pixel: the sum of the weights, then the sums of weight * value for three channels of linear colour,
// three components of the normal, and the depth. Weights and values are fixed-point fractions of these
// numbers.
LUCARNE_CONST uint kSumWords = 8u;
LUCARNE_CONST float kWeightSteps = 1023.0f;
LUCARNE_CONST float kValueSteps = 2047.0f;
// Up to this sum of weights no other sum exceeds 32 bits. Pixels beyond it, which take over 2048 discs in one
// place, keep their front disc alone.
LUCARNE_CONST uint kMostWeight = 0xffffffffu / 2047u;

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
