// How openings.comp stores its sums, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_VIEW_IMPORTANCE_OPENINGS_H
#define LUCARNE_GI_ENGINES_VPL_VIEW_IMPORTANCE_OPENINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// The sums are integers, so that their order does not matter. All importons together send at most pi.
LUCARNE_CONST float kOpeningSteps = 16777216.0f;

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
