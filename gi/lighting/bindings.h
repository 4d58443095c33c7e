// Bindings of the shaders of direct light, shared by C++ and GLSL. Their names differ from those of the
// engines, whose shaders include shadow.glsl.
#ifndef LUCARNE_GI_LIGHTING_BINDINGS_H
#define LUCARNE_GI_LIGHTING_BINDINGS_H

#ifdef __cplusplus
#include <cstdint>
namespace lucarne::gi::lighting {
using uint = uint32_t;
#endif

const uint kBindCameraTexels = 3u;  // GBufferTexel[] of the picture
const uint kBindLightTexels = 4u;   // GBufferTexel[] of a light view
const uint kBindLightingMaterials = 5u;
const uint kBindLitRadiance = 6u;
const uint kBindSky = 7u;  // r, g, b of each texel

#ifdef __cplusplus
}  // namespace lucarne::gi::lighting
#endif
#endif
