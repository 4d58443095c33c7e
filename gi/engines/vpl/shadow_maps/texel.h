// What a texel of the atlas holds where there is no surface, shared by C++ and GLSL. parabolic.glsl has the
// others.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_TEXEL_H
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_TEXEL_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

const uint kNothing = 0xffffffffu;  // nor a source (sources.glsl)

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
