// Bindings of the shaders without light, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_UNLIT_BINDINGS_H
#define LUCARNE_GI_ENGINES_UNLIT_BINDINGS_H

#ifdef __cplusplus
#include <cstdint>
namespace lucarne::gi::unlit {
using uint = uint32_t;
#endif

const uint kUnitTexels = 3u;      // GBufferTexel[]
const uint kBindObscurance = 4u;  // a float per pixel
const uint kBindRadiance = 6u;

#ifdef __cplusplus
}  // namespace lucarne::gi::unlit
#endif
#endif
