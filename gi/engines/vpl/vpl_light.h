// A virtual point light (VPL) as the device holds it (std430), shared by C++ and GLSL.
#ifndef LUCARNE_GI_VPL_VPL_LIGHT_H
#define LUCARNE_GI_VPL_VPL_LIGHT_H

#ifdef __cplusplus
#include <glm/vec4.hpp>
namespace lucarne::gi::vpl {
using vec4 = glm::vec4;
#endif

// It keeps the flux that arrives and the direction it comes from, and is shaded with the whole BRDF of its
// surface: radiance L(w) = flux * f(incident, w) over its footprint. A light with a zero normal is dead:
// nothing was hit.
struct VplLight {
    vec4 position;  // m, relative to the local origin; w: footprint A, the share of the surface it stands
                    // for, m^2
    vec4 normal;    // unit, on the lit side; w: how far its shadow map's centre is lifted off it, m
    vec4 diffuse;   // flux * kd / pi: the diffuse radiant intensity along the normal, W/sr; w: n, Phong
                    // exponent
    vec4 flux;      // incident, W; w: 1 where it stands clear in the light, else less (seeding.cpp)
    vec4 incident;  // unit, toward where the flux comes from; w: ks, specular intensity of
                    // its surface
};

#ifdef __cplusplus
/// Infinitely far away, so that no surfel enters its shadow map.
inline const VplLight kDeadLight{vec4(1e18f, 1e18f, 1e18f, 0.0f), vec4(0.0f), vec4(0.0f), vec4(0.0f),
                                 vec4(0.0f)};

static_assert(sizeof(VplLight) == 80);
}  // namespace lucarne::gi::vpl
#endif
#endif
