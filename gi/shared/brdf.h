// The reflectance model that all engines share, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_BRDF_H
#define LUCARNE_GI_SHARED_BRDF_H

#include "gi/shared/language.h"
#include "gi/shared/material.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST float kPi = 3.14159265f;
// Largest albedo of any channel. No scanned surface reflects more, and light in a closed white room would
// never die out.
LUCARNE_CONST float kLargestAlbedo = 0.95f;

// The reflectance of a surface, made from its material and the scan's colour: kd + ks <= 1 in every channel.
LUCARNE_STRUCT(Reflectance) {
    vec3 kd;
    float ks;
    float exponent;
};

LUCARNE_FN Reflectance make_reflectance(Material material, vec3 albedo) {
    Reflectance r;
    r.ks = clamp(material.diffuse.w, 0.0f, 1.0f);
    r.kd = clamp(albedo * vec3(material.diffuse.x, material.diffuse.y, material.diffuse.z), vec3(0.0f),
                 vec3(min(kLargestAlbedo, 1.0f - r.ks)));
    r.exponent = max(material.emission.w, 1.0f);
    return r;
}

// Returns the specular lobe alone, 1/sr: ks (n+2)/(2 pi) cos^n of the angle between `to` and the mirror
// direction of `from` (Lafortune & Willems 1994, "Using the modified Phong reflectance model for physically
// based rendering", eq. 7). All directions are unit and point away from the surface.
LUCARNE_FN float specular_brdf(Reflectance r, vec3 normal, vec3 from, vec3 to) {
    if (r.ks <= 0.0f) return 0.0f;
    float cosine = dot(2.0f * dot(normal, from) * normal - from, to);
    if (cosine <= 0.0f) return 0.0f;
    return r.ks * (r.exponent + 2.0f) / (2.0f * kPi) * pow(min(cosine, 1.0f), r.exponent);
}

// Returns kd/pi plus the lobe, 1/sr, without the cosine. Returns zero unless `from` and `to` are both in
// front of the surface.
LUCARNE_FN vec3 brdf(Reflectance r, vec3 normal, vec3 from, vec3 to) {
    if (dot(normal, from) <= 0.0f || dot(normal, to) <= 0.0f) return vec3(0.0f);
    return r.kd / kPi + specular_brdf(r, normal, from, to);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
