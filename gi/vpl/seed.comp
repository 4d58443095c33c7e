// One VPL a Halton point: warped by the importance map to a direction of the light, with the flux of
// Phi = I(w) / (M p(w)), p the density per solid angle (Keller 1997; importance as in Preiner 2010, section 4.2).
layout(local_size_x = 64) in;

#include "gi/shared/brdf.h"
#include "gi/shared/gbuffer.glsl"
#include "gi/vpl/importance.glsl"
#include "gi/vpl/vpl_light.h"

layout(std430, binding = 3) readonly buffer Materials { Material materials[]; };
layout(std430, binding = 4) readonly buffer LightGBuffer { GBufferTexel light_texels[]; };
layout(std430, binding = 7) readonly buffer Points { vec2 points[]; };
layout(std430, binding = 9) writeonly buffer Lights { VplLight lights[]; };

uniform uint light_count;

// Below this cosine a footprint would grow without bound; it is a grazing angle of a twentieth of a degree.
const float kLeastCosine = 1e-3;

// Infinitely far away, so that no surfel enters its shadow map.
VplLight dead_light() { return VplLight(vec4(vec3(1e18), 0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0)); }

VplLight light_on(GBufferTexel texel, uvec2 pixel, WarpedPoint warped) {
    vec3 centre = texel_position(light_view, pixel, texel);
    vec3 normal = texel_normal(texel);
    vec3 ray = view_ray(light_view, warped.at);
    // Where the ray meets the texel's surfel; beside its disc the depth of the texel is the better guess.
    vec3 hit = light_view.origin.xyz + ray * (dot(normal, centre - light_view.origin.xyz) / dot(normal, ray));
    if (!(distance(hit, centre) <= texel_radius(texel))) hit = light_view.origin.xyz + ray * texel.depth;

    vec3 away = normalize(ray);
    float density = warped.probability / ray_solid_angle(warped.at);  // 1/sr
    vec3 flux = spot_intensity(spot, away) / (float(light_count) * density);
    Reflectance r = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    float cosine = max(-dot(normal, away), kLeastCosine);
    vec3 offset = hit - light_view.origin.xyz;
    float footprint = dot(offset, offset) / (float(light_count) * density * cosine);
    return VplLight(vec4(hit, footprint), vec4(normal, r.ks), vec4(flux * r.kd / kPi, r.exponent), vec4(flux, 0.0),
                    vec4(-away, texel_radius(texel)));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= uint(lights.length())) return;
    WarpedPoint warped = WarpedPoint(vec2(0.0), 0.0);
    if (index < light_count) warped = warp(points[index]);
    VplLight light = dead_light();
    uvec2 pixel = uvec2(warped.at);
    if (warped.probability > 0.0 && pixel.x < light_view.width && pixel.y < light_view.height) {
        GBufferTexel texel = light_texels[pixel.y * light_view.width + pixel.x];
        if (texel.depth > 0.0) light = light_on(texel, pixel, warped);
    }
    lights[index] = light;
}
