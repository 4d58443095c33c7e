// Texture units of a cut, shared by C++ and GLSL. No shader uses them for anything else.
#ifndef LUCARNE_GI_SHARED_CUT_BINDINGS_H
#define LUCARNE_GI_SHARED_CUT_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kUnitCutPool = 0u;    // PackedSurfel[]
const uint kUnitCutItems = 1u;   // CutItem[], then ClipShape[]
const uint kUnitCutBlocks = 2u;  // CutBlock[]

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
