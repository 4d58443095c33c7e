// Computes level 0 of the importance map: how much light the surface behind a texel of the light G-buffer reflects.
//
// weight = I(w) * solid angle of the texel * (luminance(kd) + lobe). This is the flux that leaves, so that diffuse
// VPLs come out equally strong. With the term of the lobe the density follows the root mean square of the radiant
// intensity over the hemisphere (the least variance for an unknown receiver): kd/pi sqrt(2 pi / 3) for the diffuse
// part, ks (n+2)/(2 pi) sqrt(2 pi / (2n+3)) for the specular part, both over the factor of the diffuse part.
layout(local_size_x = 16, local_size_y = 16) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "gi/engines/vpl/seeding/importance.glsl"

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= importance_side || at.y >= importance_side) return;
    vec2 value = vec2(0.0);
    if (at.x < light_view.width && at.y < light_view.height) {
        GBufferTexel texel = light_texels[at.y * light_view.width + at.x];
        // The edge of the cone crosses texels: take the mean of centre and corners; a texel is lit if any of them is.
        float intensity = 0.0;
        for (uint i = 0u; i < 5u; ++i) {
            vec2 offset = i == 4u ? vec2(0.5) : vec2(i & 1u, i >> 1);
            vec3 ray = view_ray(light_view, vec2(at) + offset);
            float distance2 = texel.depth * texel.depth * dot(ray, ray);
            intensity += 0.2 * luminance(view_intensity(normalize(ray), distance2));
        }
        if (texel.depth > 0.0 && intensity > 0.0) {
            Reflectance r = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
            float lobe = 0.5 * r.ks * (r.exponent + 2.0) * sqrt(3.0 / (2.0 * r.exponent + 3.0));
            value = vec2(intensity * ray_solid_angle(vec2(at) + 0.5) * (luminance(r.kd) + lobe), 1.0);
        }
    }
    importance[at.y * importance_side + at.x] = value;
}
