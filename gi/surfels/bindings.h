// Bindings of the shaders that decode surfels, shared by C++ and GLSL.
#ifndef LUCARNE_GI_SURFELS_BINDINGS_H
#define LUCARNE_GI_SURFELS_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kBindFlatSurfels = 5u;

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
