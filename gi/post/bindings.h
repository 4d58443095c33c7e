// Bindings of the shaders that make pictures of radiance, shared by C++ and GLSL.
#ifndef LUCARNE_GI_POST_BINDINGS_H
#define LUCARNE_GI_POST_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::post {
#endif

// Storage buffers.
const uint kBindRadiance = 0u;
const uint kBindPicture = 1u;
const uint kBindSums = 1u;    // of luminance
const uint kBindCounts = 1u;  // of pixels by brightness
const uint kBindMean = 1u;    // of the frames so far
const uint kBindCoverage = 2u;
const uint kBindOther = 2u;  // the other engine's radiance, or its picture
const uint kBindMaterials = 3u;

// Texture units.
const uint kUnitGBuffer = 3u;

// highlights.comp counts blocks of this many pixels along a side.
const uint kBlockSide = 4u;
// The bins of highlights.comp: 16 stops below and above the log-average.
const int kBinsPerStop = 8;
const int kBrightnessBins = 256;

#ifdef __cplusplus
}  // namespace lucarne::gi::post
#endif
#endif
