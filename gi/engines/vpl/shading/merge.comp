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
        int lacking = tiles_lacking(n, joint.y);
        // The light that shade_isolated.comp added for isolated pixels; 0 for all others.
        vec3 irradiance = texelFetch(own_diffuse, int(index)).xyz;
        vec3 specular = vec3(0.0);
#ifdef LUCARNE_GLOSSY
        specular = texelFetch(own_specular, int(index)).xyz;
#endif
        for (int i = 0; i < n * n; ++i) {
            ivec2 at = window_pixel(ivec2(pixel), n, i, int(joint.x >> 2 * i & 3u));
            if ((joint.y >> i & 1u) != 0u) continue;
            int other = at.y * int(camera.width) + at.x;
            irradiance += texelFetch(diffuse_tiles, other).xyz;
#ifdef LUCARNE_GLOSSY
            specular += texelFetch(specular_tiles, other).xyz;
#endif
        }
        float tiles = float(n * n - bitCount(joint.y) + lacking);
        Receiver receiver = pixel_receiver(pixel, texel);
        irradiance /= tiles;
#ifdef LUCARNE_HISTORY
        irradiance = with_history(index, receiver.position, receiver.normal, texel.depth, irradiance);
#endif
        light = irradiance * receiver.reflectance.kd / kPi + specular / tiles;
    }
#ifdef LUCARNE_HISTORY
    else
        next_surfaces[index] = uvec2(0u);
#endif
    radiance[index] = vec4(light, 1.0);
}
