// The relative luminance of linear Rec. 709 light (ITU-R BT.709-6, section 3.2), for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_LUMINANCE_H
#define LUCARNE_GI_SHARED_LUMINANCE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST float kRedWeight = 0.2126f, kGreenWeight = 0.7152f, kBlueWeight = 0.0722f;
LUCARNE_FN float luminance(vec3 rgb) {
    return dot(rgb, vec3(kRedWeight, kGreenWeight, kBlueWeight));
}

#ifdef __cplusplus
inline double luminance(const glm::dvec3& rgb) {
    return glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722));
}
}  // namespace lucarne::gi
#endif
#endif
