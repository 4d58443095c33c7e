// The list of isolated pixels between join.comp and shade_isolated.comp, shared by C++ and GLSL (std430).
#ifndef LUCARNE_GI_ENGINES_VPL_SHADING_ISOLATED_H
#define LUCARNE_GI_ENGINES_VPL_SHADING_ISOLATED_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

const uint kIsolatedGroup = 64u;          // pixels that a workgroup of shade_isolated.comp shades at a time
const uint kMostIsolatedGroups = 65535u;  // that OpenGL guarantees

// Before the pixels. join.comp raises the workgroups, which dispatch_indirect reads, with the count.
struct IsolatedHeader {
    uint groups[3];
    uint count;
};

#ifdef __cplusplus
static_assert(sizeof(IsolatedHeader) == 16);
}  // namespace lucarne::gi::vpl
#endif
#endif
