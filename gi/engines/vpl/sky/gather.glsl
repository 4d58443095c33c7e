// Computes the light of the sky at a point, in place of that of VPLs (shading/gather.glsl).
#include "gi/engines/vpl/shading/receiver.glsl"
#include "gi/engines/vpl/sky/sky_map.h"

layout(std430, binding = kBindLights) readonly buffer SkyMaps { SkyMap sky_maps[]; };
layout(binding = kUnitAtlas) uniform usamplerBuffer sky_texels;

uniform float depth_step;

// Sums the light of every `stride`-th direction from `first` on.
Gathered gather(Receiver receiver, uint first, uint stride, uint count) {
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    for (uint i = first; i < count; i += stride) {
        SkyMap map = sky_maps[i];
        float cosine = -dot(receiver.normal, map.away.xyz);
        if (!(cosine > 0.0)) continue;
        float lift = sky_lift(map, receiver.radius);
        vec3 place = sky_place(map, receiver.position + receiver.normal * lift);
        vec2 corner = sky_corner(map, place.xy);
        int at = int(sky_texel_index(map, corner));
        if (sky_blocks(map, texelFetch(sky_texels, at).x, corner, place, depth_step, receiver.normal, receiver.radius,
                       lift))
            continue;
        vec3 irradiance = map.irradiance.rgb * cosine;
        sum.irradiance += irradiance;
#ifdef LUCARNE_GLOSSY
        if (dot(receiver.normal, receiver.to_viewer) > 0.0)
            sum.specular +=
                irradiance * specular_brdf(receiver.reflectance, receiver.normal, -map.away.xyz, receiver.to_viewer);
#endif
    }
    return sum;
}
