// What a spot light sends where, for C++ and GLSL alike.
#ifndef LUCARNE_GI_SHARED_SPOT_H
#define LUCARNE_GI_SHARED_SPOT_H

#include "gi/shared/language.h"
#include "gi/shared/material.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Radiant intensity, W/sr, in the unit direction `away` from the light: smoothstep of the cosine between the outer
// and the inner edge.
LUCARNE_FN vec3 spot_intensity(SpotLight spot, vec3 away) {
    float cosine = dot(away, vec3(spot.direction.x, spot.direction.y, spot.direction.z));
    float outer = spot.position.w;
    float width = spot.direction.w - outer;
    float t = width > 0.0f ? clamp((cosine - outer) / width, 0.0f, 1.0f) : (cosine >= outer ? 1.0f : 0.0f);
    return vec3(spot.intensity.x, spot.intensity.y, spot.intensity.z) * (t * t * (3.0f - 2.0f * t));
}

// Irradiance, W/m^2, of an unshadowed surface at `position`; `to_light` receives the unit direction to the light.
// Zero behind the surface and at the light itself.
LUCARNE_FN vec3 spot_irradiance(SpotLight spot, vec3 position, vec3 normal, LUCARNE_OUT(vec3) to_light) {
    vec3 offset = vec3(spot.position.x, spot.position.y, spot.position.z) - position;
    float distance2 = dot(offset, offset);
    to_light = normal;
    if (!(distance2 > 0.0f)) return vec3(0.0f);
    to_light = offset * inversesqrt(distance2);
    return spot_intensity(spot, -to_light) * (max(dot(normal, to_light), 0.0f) / distance2);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
