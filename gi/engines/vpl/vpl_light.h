// A virtual point light (VPL) as the device stores it (std430), shared by C++ and GLSL.
#ifndef LUCARNE_GI_VPL_VPL_LIGHT_H
#define LUCARNE_GI_VPL_VPL_LIGHT_H

#include "gi/shared/language.h"

#ifdef __cplusplus
#include <glm/vec4.hpp>
namespace lucarne::gi::vpl {
using vec4 = glm::vec4;
#endif

// flux.w of a VPL on the rim of a disc that sticks out where there is no surface.
LUCARNE_CONST float kStray = -1.0f;
LUCARNE_CONST float kSameSurface = 0.7f;  // least cosine between normals of one surface

// A VPL holds the flux that arrives and the direction it comes from, and is shaded with the whole BRDF of
// its surface: radiance L(w) = flux * f(incident, w) over its footprint. A VPL with a zero normal is dead:
// nothing was hit.
struct VplLight {
    vec4 position;  // m, relative to the local origin; w: footprint A, its share of the surface, m^2
    vec4 normal;    // unit, on the lit side; w: distance of its shadow map's centre along it, m
    vec4 diffuse;   // flux * kd / pi: diffuse radiant intensity along the normal, W/sr; w: Phong exponent n
    vec4 flux;  // incident, W; w: 1 if its surfel is wholly in the light, else less, or kStray (seed.comp)
    vec4 incident;  // unit, toward the source of the flux; w: ks, specular intensity of its surface
};

#ifdef __cplusplus
/// A VPL infinitely far away, so that no surfel is drawn into its shadow map.
inline const VplLight kDeadLight{vec4(1e18f, 1e18f, 1e18f, 0.0f), vec4(0.0f), vec4(0.0f), vec4(0.0f),
                                 vec4(0.0f)};

static_assert(sizeof(VplLight) == 80);
}  // namespace lucarne::gi::vpl
#endif
#endif
