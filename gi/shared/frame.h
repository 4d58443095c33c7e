// An orthonormal frame about a unit vector (Duff et al. 2017, "Building an orthonormal basis, revisited"),
// for C++, GLSL and OpenCL C: tangent, bitangent and n are right-handed.
#ifndef LUCARNE_GI_SHARED_FRAME_H
#define LUCARNE_GI_SHARED_FRAME_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_FN void frame_about(vec3 n, LUCARNE_OUT(vec3) tangent, LUCARNE_OUT(vec3) bitangent) {
    float s = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (s + n.z);
    float b = n.x * n.y * a;
    LUCARNE_VALUE(tangent) = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    LUCARNE_VALUE(bitangent) = vec3(b, s + n.y * n.y * a, -n.y);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
