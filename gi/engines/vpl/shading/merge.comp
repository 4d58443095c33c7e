// Writes the indirect light of every pixel: the mean over its interleaved tiles, so that every VPL counts
// alike, times the reflectance of the receiver, plus its specular light.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/join.glsl"
#ifdef LUCARNE_HISTORY
#include "gi/engines/vpl/shading/history.glsl"
#endif

layout(binding = kUnitDiffuse) uniform samplerBuffer diffuse_tiles;
layout(binding = kUnitSpecular) uniform samplerBuffer specular_tiles;
layout(binding = kUnitOwnDiffuse) uniform samplerBuffer own_diffuse;
layout(binding = kUnitOwnSpecular) uniform samplerBuffer own_specular;
layout(std430, binding = kBindRadiance) writeonly buffer Radiance { vec4 radiance[]; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= camera.width || pixel.y >= camera.height) return;
    uint index = pixel.y * camera.width + pixel.x;
    GBufferTexel texel = camera_texel(index);
    vec3 light = vec3(0.0);
    if (texel.depth > 0.0) {
        int n = int(interleave);
        uvec2 joint = joints[index];
        uint missing = missing_tiles(n, joint);
        int lacking = tiles_lacking(n, missing);
        // The light that shade_isolated.comp added for isolated pixels; 0 for all others.
        vec3 irradiance = texelFetch(own_diffuse, int(index)).xyz;
        vec3 specular = vec3(0.0);
#ifdef LUCARNE_GLOSSY
        specular = texelFetch(own_specular, int(index)).xyz;
#endif
        for (int i = 0; i < n * n; ++i) {
            uint candidates = candidates_of(joint, i);
            vec3 tile_irradiance = vec3(0.0), tile_specular = vec3(0.0);
            float weights = 0.0;
            while (candidates != 0u) {
                int j = findLSB(candidates);
                candidates &= candidates - 1u;
                ivec2 at = window_pixel(ivec2(pixel), n, i, j);
                int other = at.y * int(camera.width) + at.x;
                float weight = candidate_weight(n, i, j);
                weights += weight;
                tile_irradiance += weight * texelFetch(diffuse_tiles, other).xyz;
#ifdef LUCARNE_GLOSSY
                tile_specular += weight * texelFetch(specular_tiles, other).xyz;
#endif
            }
            if (weights > 0.0) {
                irradiance += tile_irradiance / weights;
                specular += tile_specular / weights;
            }
        }
        float tiles = float(n * n - bitCount(missing) + lacking);
        Receiver receiver = pixel_receiver(pixel, texel);
        irradiance /= tiles;
#ifdef LUCARNE_HISTORY
        irradiance = with_history(index, receiver, texel, irradiance);
#endif
        light = irradiance * receiver.reflectance.kd / kPi + specular / tiles;
    }
#ifdef LUCARNE_HISTORY
    else
        next_surfaces[index] = uvec2(0u);
#endif
    radiance[index] = vec4(light, 1.0);
}
