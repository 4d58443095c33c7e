// Which discs are blended in a pixel, and how much each counts, shared by C++ and GLSL. blend.glsl and
// slab.glsl have the method.
#ifndef LUCARNE_GI_RASTER_BLEND_WEIGHTS_H
#define LUCARNE_GI_RASTER_BLEND_WEIGHTS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::raster {
#endif

// The slab about the front surface reaches this share of the front disc's radius to either side of its plane.
// Planes of one surface differ by their noise and by its curvature.
LUCARNE_CONST float kSlab = 0.5f;

// Discs whose normals differ by less than the first angle belong to one smooth surface; over the second they
// meet at a crease. Between them their weight falls, so that no border shows on surfaces with noisy normals.
LUCARNE_CONST float kCosSmooth = 0.906f;  // 25 degrees
LUCARNE_CONST float kCosCrease = 0.643f;  // 50 degrees

// Weights below this share contribute nothing.
LUCARNE_CONST float kLeastWeight = 1.0f / 32.0f;
LUCARNE_CONST float kLeastWeightAt = 0.685f;  // (distance / radius)^2 of that weight

// By this reach, in pixels, small discs are widened (blend.comp).
LUCARNE_CONST float kPixelReach = 0.7f;

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
