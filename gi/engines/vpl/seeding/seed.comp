// Places one VPL per Halton point. The importance map warps the point to a direction of the light; the flux is Phi =
// I(w) / (M p(w)), p the density per solid angle (Keller 1997; importance as in Preiner 2010, section 4.2).
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/cut.glsl"
#include "gi/engines/vpl/seeding/importance.glsl"
#include "gi/engines/vpl/vpl_light.h"

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindLightIds) readonly buffer LightIds { uint light_ids[]; };
layout(std430, binding = kBindPoints) readonly buffer Points { vec2 points[]; };
layout(std430, binding = kBindLights) writeonly buffer Lights { VplLight lights[]; };

uniform uint first_light, light_count;

// Below this cosine a footprint would grow without bound; the angle to the surface is then a twentieth of a degree.
const float kLeastFacing = 1e-3;

// A VPL infinitely far away, so that no surfel is drawn into its shadow map.
VplLight dead_light() { return VplLight(vec4(vec3(1e18), 0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0)); }

// Returns how much of the light reaches the centre of a surfel. If it is shadowed, the light sees only the rim of a
// disc that sticks out at an edge, perhaps out of a sealed room.
float stands_clear(uint id, vec3 normal, float radius) {
    uint item;
    PackedSurfel surfel;
    if (id == kNoSurfel || !cut_surfel(id, item, surfel)) return 1.0;
    return spot_visibility(surfel_position(item, surfel), normal, radius);
}

// Returns the VPL of a texel. It stands where the central ray of the texel ends: elsewhere in the texel it might lie
// behind the surface that hides the rest of the surfel from the light, for instance inside a sealed room.
VplLight light_on(GBufferTexel texel, uvec2 pixel, float probability) {
    vec3 position = texel_position(light_view, pixel, texel);
    vec3 normal = texel_normal(texel);
    vec2 centre = vec2(pixel) + 0.5;
    vec3 ray = view_ray(light_view, centre);
    vec3 away = normalize(ray);
    float density = probability / ray_solid_angle(centre);  // 1/sr
    vec3 offset = position - light_view.origin.xyz;
    vec3 flux = view_intensity(away, dot(offset, offset)) / (float(light_count) * density);
    Reflectance r = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    float cosine = max(-dot(normal, away), kLeastFacing);
    float footprint = dot(offset, offset) / (float(light_count) * density * cosine);
    return VplLight(vec4(position, footprint), vec4(normal, texel_radius(texel)), vec4(flux * r.kd / kPi, r.exponent),
                    vec4(flux, stands_clear(light_ids[pixel.y * light_view.width + pixel.x], normal, texel_radius(texel))),
                    vec4(-away, r.ks));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= light_count) return;
    WarpedPoint warped = warp(points[index]);
    VplLight seeded = dead_light();
    uvec2 pixel = uvec2(warped.at);
    if (warped.probability > 0.0 && pixel.x < light_view.width && pixel.y < light_view.height) {
        GBufferTexel texel = light_texels[pixel.y * light_view.width + pixel.x];
        if (texel.depth > 0.0) seeded = light_on(texel, pixel, warped.probability);
    }
    lights[first_light + index] = seeded;
}
