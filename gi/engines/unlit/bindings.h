// Bindings of the shaders without light, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_UNLIT_BINDINGS_H
#define LUCARNE_GI_ENGINES_UNLIT_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::unlit {
#endif

const uint kUnitTexels = 3u;      // GBufferTexel[]
const uint kBindObscurance = 4u;  // a float per pixel
const uint kBindRadiance = 6u;

#ifdef __cplusplus
}  // namespace lucarne::gi::unlit
#endif
#endif
