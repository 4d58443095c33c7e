// The light that a disc sends to a point, for C++ and GLSL.
#ifndef LUCARNE_GI_SHARED_DISC_FORM_FACTOR_H
#define LUCARNE_GI_SHARED_DISC_FORM_FACTOR_H

#include "gi/shared/brdf.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Returns the form factor, times pi, from a point to a disc of squared radius r2 whose centre lies at
// -offset: pi times what a disc of unit radiosity sends to the point. In the plane of the disc's normal and
// the offset the light vector has closed form (Howell, catalogue of radiation configuration factors, B-12 and
// B-13: elements parallel and perpendicular to a disc), here without their cancellations far away. The part
// of the disc behind the receiver's plane counts partly, as the mean of two rules: one cuts it off like a
// sphere of the same solid angle (a parabola through the ends of the exact formula, off by at most 2 % of the
// whole), the other loses nothing (after Hill: (l^2 + z) / (l + 1)). The reason: a disc that crosses the
// plane stands for surface that ends there, and losing all of that part would darken every corner
// (gi/engines/vpl/README.md).
LUCARNE_FN float disc_form_factor(vec3 normal, vec3 light_normal, vec3 offset, float r2) {
    float height = dot(light_normal, offset);
    vec3 lateral = offset - height * light_normal;
    float a2 = dot(lateral, lateral);
    float d2 = dot(offset, offset);
    float s = sqrt(max((d2 + r2) * (d2 + r2) - 4.0f * a2 * r2, 1e-30f));
    float parallel = d2 > r2 ? 2.0f * height * height * r2 / (s * (s + d2 - r2)) : 0.5f * (s + r2 - d2) / s;
    float lateral_share = 2.0f * height * r2 / (s * (d2 + r2 + s));
    vec3 flux = -parallel * light_normal - lateral_share * lateral;
    float size = max(length(flux), 1e-30f);
    float facing = dot(flux, normal);
    float sine = sqrt(size);
    float cosine = facing / size;
    float above = max(cosine + sine, 0.0f);
    float cut = cosine >= sine ? facing : size * above * above / (4.0f * sine);
    return kPi * 0.5f * (cut + max((size * size + facing) / (size + 1.0f), 0.0f));
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
