// The specular light that leaves a surfel or a node, for C++ and OpenCL C: one lobe for all lights and
// surfels. It is held as the sum of what each sends out, which is linear: its light, and the unit directions
// to which it goes, each times the lobe's mean cosine and the mean of its three colours. The longer the sum
// of directions, the narrower is the lobe; Toksvig 2005, "Mipmapping normal maps", widens lobes by the length
// of mean normals alike.
#ifndef LUCARNE_GI_SHARED_LOBE_H
#define LUCARNE_GI_SHARED_LOBE_H

#include "gi/shared/brdf.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST float kLargestLobeExponent = 1e5f;  // sums in floats cannot tell narrower lobes apart

LUCARNE_FN float mean_colour(vec3 rgb) {
    return (rgb.x + rgb.y + rgb.z) / 3.0f;
}
// Returns the mean of the cosine to the axis of a lobe cos^n over the half space about it.
LUCARNE_FN float lobe_mean_cosine(float exponent) {
    return (exponent + 1.0f) / (exponent + 2.0f);
}
// Returns the exponent of the lobe with this mean cosine; lobes wider than the half space do not exist.
LUCARNE_FN float lobe_exponent(float mean_cosine) {
    float most = lobe_mean_cosine(kLargestLobeExponent);
    float cosine = min(mean_cosine, most);
    return max((2.0f * cosine - 1.0f) / (1.0f - cosine), 0.0f);
}
// Returns the radiance of a lobe in the unit direction `to`, for each unit of its light, 1/sr
// (specular_brdf).
LUCARNE_FN float lobe_radiance(vec3 light, vec3 directions, vec3 to) {
    float size = length(directions), along = dot(directions, to);
    if (!(along > 0.0f)) return 0.0f;
    float exponent = lobe_exponent(size / mean_colour(light));
    return (exponent + 2.0f) / (2.0f * kPi) * pow(min(along / size, 1.0f), exponent);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
