// Floats as words of the same order, for atomic minima and maxima; for C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_SKY_ORDERED_H
#define LUCARNE_GI_ENGINES_VPL_SKY_ORDERED_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

LUCARNE_FN uint ordered_code(float value) {
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
LUCARNE_FN float ordered_value(uint code) {
    return uintBitsToFloat((code & 0x80000000u) != 0u ? code & 0x7fffffffu : ~code);
}

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
