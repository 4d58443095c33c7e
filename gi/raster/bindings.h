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

// Texture units.
const uint kUnitKeys = 3u;

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
