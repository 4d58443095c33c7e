// Bindings of the shaders that decode surfels, shared by C++ and GLSL.
#ifndef LUCARNE_GI_SURFELS_BINDINGS_H
#define LUCARNE_GI_SURFELS_BINDINGS_H

#ifdef __cplusplus
#include <cstdint>
namespace lucarne::gi {
using uint = uint32_t;
#endif

const uint kBindFlatSurfels = 5u;

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
