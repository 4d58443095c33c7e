// Places one VPL per Halton point. The importance map warps the point to a direction of the light; the flux is Phi =
// I(w) / (M p(w)), p the density per solid angle (Keller 1997; importance as in Preiner 2010, section 4.2).
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/cut.glsl"
#include "gi/shared/frame.h"
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

// Returns how much of the light reaches the centre of the surfel in a texel. If it is shadowed, the light sees only the
// rim of a disc.
float centre_visibility(uvec2 pixel) {
    uint index = pixel.y * light_view.width + pixel.x;
    uint item;
    PackedSurfel surfel;
    if (light_ids[index] == kNoSurfel || !cut_surfel(light_ids[index], item, surfel)) return 1.0;
    GBufferTexel texel = light_texels[index];
    return spot_visibility(surfel_position(item, surfel), texel_normal(texel), texel_radius(texel));
}

// Returns whether the surface goes on beside the rim of a disc to where centres of discs are lit: then the rim lies at
// the border of a patch of light. Else it sticks out at an edge, perhaps out of a sealed room, where no surface is.
bool at_lit_surface(vec3 position, vec3 normal, float radius) {
    vec3 tangent, bitangent;
    frame_about(normal, tangent, bitangent);
    for (int i = 0; i < 16; ++i) {
        float angle = float(i) * (kPi / 4.0);
        vec3 along = tangent * cos(angle) + bitangent * sin(angle);
        vec3 beside = position + along * (radius * (i < 8 ? 1.0 : 2.0));
        float depth;
        ivec2 pixel = ivec2(floor(view_place(light_view, beside, depth)));
        if (depth <= 0.0 || any(lessThan(pixel, ivec2(0))) ||
            any(greaterThanEqual(pixel, ivec2(light_view.width, light_view.height))))
            continue;
        GBufferTexel texel = light_texels[uint(pixel.y) * light_view.width + uint(pixel.x)];
        if (!(texel.depth > 0.0) || dot(texel_normal(texel), normal) < kSameSurface) continue;
        vec3 offset = texel_position(light_view, uvec2(pixel), texel) - position;
        if (abs(dot(offset, normal)) > radius || length(offset) > 4.0 * radius) continue;
        if (centre_visibility(uvec2(pixel)) > 0.0) return true;
    }
    return false;
}

// Returns the share of the light at a VPL's surfel: 1 if the light sees its centre, less at the border of a patch of
// light, kStray on a rim without a surface.
float stands_clear(uvec2 pixel, vec3 position, vec3 normal, float radius) {
    float visible = centre_visibility(pixel);
    return visible > 0.0 || at_lit_surface(position, normal, radius) ? visible : kStray;
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
                    vec4(flux, stands_clear(pixel, position, normal, texel_radius(texel))),
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
