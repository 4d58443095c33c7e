// Computes the light of the sky at a point, in place of that of VPLs (shading/gather.glsl).
#include "gi/engines/vpl/shading/receiver.glsl"
#include "gi/engines/vpl/shading/sky_map.h"

layout(std430, binding = kBindLights) readonly buffer SkyMaps { SkyMap sky_maps[]; };
layout(binding = kUnitAtlas) uniform usamplerBuffer sky_texels;

uniform float depth_step;

// Returns whether the light of a map is blocked. Silhouettes lie between the middles of texels: where the texel of a
// receiver is not sure, its three neighbours around the receiver decide. Otherwise light would come in along the seams
// of a room.
bool sky_blocks(SkyMap map, Receiver receiver) {
    vec3 moved = sky_moved(map, receiver.normal, receiver.to_viewer, receiver.radius);
    vec3 place = sky_place(map, receiver.position + moved);
    vec2 corner = sky_corner(map, place.xy);
    vec2 beside = vec2(sky_neighbour(corner.x, place.x, float(map.columns)),
                       sky_neighbour(corner.y, place.y, float(map.rows)));
    for (int i = 0; i < 4; ++i) {
        vec2 at = vec2((i & 1) == 0 ? corner.x : beside.x, (i & 2) == 0 ? corner.y : beside.y);
        uint texel = texelFetch(sky_texels, int(sky_texel_index(map, at))).x;
        uint verdict = sky_verdict(map, texel, at, place, depth_step, receiver.normal, receiver.radius, moved);
        if (verdict == kSkyBlocks) return true;
        if (verdict == kSkyClear && i == 0) return false;
    }
    return false;
}

// Sums the light of every `stride`-th direction from `first` on.
Gathered gather(Receiver receiver, uint first, uint stride, uint count) {
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    for (uint i = first; i < count; i += stride) {
        SkyMap map = sky_maps[i];
        float cosine = -dot(receiver.normal, map.away.xyz);
        if (!(cosine > 0.0)) continue;
        if (sky_blocks(map, receiver)) continue;
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
