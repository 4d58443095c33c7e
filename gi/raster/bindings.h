// Bindings of the shaders that draw surfels into a G-buffer, shared by C++ and GLSL.
#ifndef LUCARNE_GI_RASTER_BINDINGS_H
#define LUCARNE_GI_RASTER_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::raster {
#endif

// Storage buffers.
const uint kBindKeys = 3u;    // depths, a word per pixel
const uint kBindIds = 4u;     // surfel ids, a word per pixel
const uint kBindQueues = 5u;  // queues.h
const uint kBindTexels = 6u;  // GBufferTexel[]
const uint kBindCandidates = 7u;
const uint kBindBlocks = 8u;     // the cut's blocks: 1 for each that is seen, then a list of these
const uint kBindSums = 9u;       // blend_sums.h
const uint kBindCoverage = 10u;  // coverage_code.h

// Texture units.
const uint kUnitKeys = 3u;
const uint kUnitFront = 4u;  // GBufferTexel[]
const uint kUnitSums = 5u;

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
