// Materials as devices store them (std430), for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_MATERIAL_H
#define LUCARNE_GI_SHARED_MATERIAL_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// BRDF: kd/pi + ks (n+2)/(2 pi) cos^n(angle to the mirror direction), kd + ks <= 1 in every channel.
// kd = min(albedo * diffuse, .95, 1 - ks).
// Surfels and G-buffers refer to a material by an eight-bit index. Devices hold this many materials, so that
// every index is valid.
#define LUCARNE_DEVICE_MATERIALS 256

LUCARNE_STRUCT(Material) {
    vec4 diffuse;   // rgb scale of the scan's colour; w: ks, specular intensity
    vec4 emission;  // rgb radiance, W/(sr m^2); w: n, Phong exponent
#ifdef __cplusplus
    bool operator==(const Material&) const = default;
#endif
};

#ifdef __cplusplus
static_assert(sizeof(Material) == 32);
}  // namespace lucarne::gi
#endif
#endif
