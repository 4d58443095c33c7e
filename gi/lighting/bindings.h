// Bindings of the shaders of direct light, shared by C++ and GLSL. Their names differ from those of the
// engines, whose shaders include shadow.glsl.
#ifndef LUCARNE_GI_LIGHTING_BINDINGS_H
#define LUCARNE_GI_LIGHTING_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::lighting {
#endif

const uint kBindCameraTexels = 3u;  // GBufferTexel[] of the picture
const uint kBindLightTexels = 4u;   // GBufferTexel[] of a light view
const uint kBindLightingMaterials = 5u;
const uint kBindLitRadiance = 6u;
const uint kBindSky = 7u;               // r, g, b of each texel
const uint kBindLitSurfels = 5u;        // FlatSurfel[]; no shader binds materials as well
const uint kBindSurfelIrradiance = 6u;  // of each surfel: r, g, b of its front, then of its back
const uint kBindSurfelDirections = 7u;  // likewise x, y, z; no shader binds a sky as well

#ifdef __cplusplus
}  // namespace lucarne::gi::lighting
#endif
#endif
