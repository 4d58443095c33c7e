// Sizes of workgroups that work on one shadow map each, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_GROUPS_H
#define LUCARNE_GI_ENGINES_VPL_GROUPS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

LUCARNE_CONST uint kTrimGroup = 64u;  // footprints.comp
LUCARNE_CONST uint kRaceGroup = 64u;  // redistribute.comp

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
