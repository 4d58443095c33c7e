// Lights as devices store them (std430) and the light that they emit, for C++, GLSL and OpenCL C.
//
// Lights are not surfaces: no camera sees them and they block no light. Their light counts where it is first
// reflected (bounce 0). Emissive surfaces are surfels whose Material has an emission.
#ifndef LUCARNE_GI_SHARED_LIGHT_H
#define LUCARNE_GI_SHARED_LIGHT_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST uint kSpotLight = 0u;         // from a point, within a cone
LUCARNE_CONST uint kPointLight = 1u;        // from a point, everywhere
LUCARNE_CONST uint kDirectionalLight = 2u;  // from infinitely far away, from a cap of the sky: the sun
LUCARNE_CONST uint kRectangleLight = 3u;    // from one side of a rectangle, one radiance in all directions
LUCARNE_CONST uint kDiscLight = 4u;         // from one side of a disc, one radiance in all directions
// From one point of a rectangle or disc; the intensity falls as the cosine. Rectangles and discs are sampled
// by such points.
LUCARNE_CONST uint kCosineLight = 5u;

// How many times as wide each of a directional light's nested views is as the next finer one.
LUCARNE_CONST float kNestedStep = 4.0f;

// What each field holds, by kind. Fields that a kind does not name are unused.
//   position   spot, point, cosine, rectangle, disc: the middle, m, relative to the local origin;
//              w of a spot: cos_outer;
//              directional with nested views (gi/lighting/nested_views.h): the middle of these views;
//              w: half the width of the finest, m
//   direction  unit, the way the light goes (cosine, rectangle, disc: the normal of the emitting side);
//              w of a spot: cos_inner; w of a directional light: angular radius of the cap, 0 to pi/2
//   strength   spot, point, cosine: radiant intensity, W/sr (cosine: along the normal);
//              directional: irradiance of a surface that faces the light, W/m^2;
//              rectangle, disc: radiance, W/(sr m^2)
//   extent     rectangle: from the middle to the middle of one edge, m; w: half the other edge, m;
//              disc: w: radius, m;
//              cosine: unit, perpendicular to the normal: the first axis of its four faces (light_face)
// A spot's intensity falls from its full value at cos_inner to 0 at cos_outer (the cosine of half the full
// angle) as the smoothstep of the cosine.
LUCARNE_STRUCT(Light) {
    vec4 position;
    vec4 direction;
    vec4 strength;
    vec4 extent;
    uint kind;
    uint nested;  // directional: how many views it has, 0 or 1: one
    uint pad0, pad1;
#ifdef __cplusplus
    bool operator==(const Light&) const = default;
#endif
};

// Returns the radiant intensity, W/sr, of a spot, point or cosine light in the unit direction `away` from
// it.
LUCARNE_FN vec3 light_intensity(Light light, vec3 away) {
    vec3 strength = vec3(light.strength.x, light.strength.y, light.strength.z);
    if (light.kind == kPointLight) return strength;
    float cosine = dot(away, vec3(light.direction.x, light.direction.y, light.direction.z));
    if (light.kind == kCosineLight) return strength * max(cosine, 0.0f);
    float outer = light.position.w;
    float width = light.direction.w - outer;
    float t = width > 0.0f ? clamp((cosine - outer) / width, 0.0f, 1.0f) : (cosine >= outer ? 1.0f : 0.0f);
    return strength * (t * t * (3.0f - 2.0f * t));
}

// Returns the face of the cube about a point light that an offset from it goes through: +x, -x, +y, -y, +z,
// -z.
LUCARNE_FN uint cube_face(vec3 offset) {
    vec3 size = abs(offset);
    if (size.x >= size.y && size.x >= size.z) return offset.x > 0.0f ? 0u : 1u;
    if (size.y >= size.z) return offset.y > 0.0f ? 2u : 3u;
    return offset.z > 0.0f ? 4u : 5u;
}

// Returns the finest of a directional light's nested views that shows what is at an offset from their middle.
// Each but the last reaches kNestedStep times as far across the direction as the one before; the last shows
// everything.
LUCARNE_FN uint nested_view(Light light, vec3 offset) {
    vec3 direction = vec3(light.direction.x, light.direction.y, light.direction.z);
    vec3 across = offset - direction * dot(offset, direction);
    float beyond = length(across) / light.position.w;
    uint view = 0u;
    while (view + 1u < light.nested && beyond > 1.0f) {
        beyond /= kNestedStep;
        ++view;
    }
    return view;
}

// Returns the face of a light that an offset from it goes through: one of the six faces of a point light's
// cube, one of the four quarters of a cosine light's half space (about its normal), one of the nested views
// of a directional light, else 0.
LUCARNE_FN uint light_face(Light light, vec3 offset) {
    if (light.kind == kPointLight) return cube_face(offset);
    if (light.kind == kDirectionalLight && light.nested > 1u) return nested_view(light, offset);
    if (light.kind != kCosineLight) return 0u;
    vec3 normal = vec3(light.direction.x, light.direction.y, light.direction.z);
    vec3 side = vec3(light.extent.x, light.extent.y, light.extent.z);
    return (dot(offset, side) < 0.0f ? 1u : 0u) + (dot(offset, cross(normal, side)) < 0.0f ? 2u : 0u);
}

// Returns the irradiance, W/m^2, of an unshadowed surface at `position` by a spot, point, cosine or
// directional light. A directional light counts as if all of it came from the middle of its cap. Sets
// `to_light` to the unit direction to the light. Returns zero behind the surface and at the light itself.
LUCARNE_FN vec3 light_irradiance(Light light, vec3 position, vec3 normal, LUCARNE_OUT(vec3) to_light) {
    if (light.kind == kDirectionalLight) {
        LUCARNE_VALUE(to_light) = vec3(-light.direction.x, -light.direction.y, -light.direction.z);
        return vec3(light.strength.x, light.strength.y, light.strength.z) *
               max(dot(normal, LUCARNE_VALUE(to_light)), 0.0f);
    }
    vec3 offset = vec3(light.position.x, light.position.y, light.position.z) - position;
    float distance2 = dot(offset, offset);
    LUCARNE_VALUE(to_light) = normal;
    if (!(distance2 > 0.0f)) return vec3(0.0f);
    LUCARNE_VALUE(to_light) = offset * inversesqrt(distance2);
    return light_intensity(light, -LUCARNE_VALUE(to_light)) *
           (max(dot(normal, LUCARNE_VALUE(to_light)), 0.0f) / distance2);
}

#ifdef __cplusplus
static_assert(sizeof(Light) == 80);
}  // namespace lucarne::gi
#endif
#endif
