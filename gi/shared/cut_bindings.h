// Texture units of a cut, for C++ and GLSL. No shader uses them for anything else.
#ifndef LUCARNE_GI_SHARED_CUT_BINDINGS_H
#define LUCARNE_GI_SHARED_CUT_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST uint kUnitCutPool = 0u;    // PackedSurfel[]
LUCARNE_CONST uint kUnitCutItems = 1u;   // CutItem[], then ClipShape[]
LUCARNE_CONST uint kUnitCutBlocks = 2u;  // CutBlock[]

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
