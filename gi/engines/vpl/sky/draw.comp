// Draws the casters into the shadow maps of directions of the sky: one invocation a surfel and map. A texel is covered
// if the ray through its middle meets a disc. Unlike the splats of VPLs' maps, discs are drawn as large as they are,
// and all of them, so windows keep their size.
#include "gi/engines/vpl/shadow_maps/casters.glsl"
#include "gi/engines/vpl/shading/sky_map.h"
#include "gi/shared/disc.h"
#include "gi/shared/surfel.h"

layout(local_size_x = kBlockSurfels) in;

layout(std430, binding = kBindLights) readonly buffer SkyMaps { SkyMap maps[]; };
layout(std430, binding = kBindAtlas) buffer SkyTexels { uint texels[]; };

uniform float depth_step;

// Returns the texels, first and last, whose middles a disc may cover along a side of `count` texels.
ivec2 range(float place, float reach, uint count) {
    float last = min(floor(place + reach - 0.5), float(count) - 1.0);
    return ivec2(max(ceil(place - reach - 0.5), 0.0), last);
}

void main() {
    Caster caster = read_caster(gl_GlobalInvocationID.x);
    if (!(caster.radius > 0.0)) return;
    caster.radius *= kSkyRadius;
    SkyMap map = maps[gl_GlobalInvocationID.y];
    vec2 size = vec2(inversesqrt(dot(map.across.xyz, map.across.xyz)), inversesqrt(dot(map.down.xyz, map.down.xyz)));
    vec3 normal = vec3(dot(caster.normal, map.across.xyz) * size.x, dot(caster.normal, map.down.xyz) * size.y,
                       -dot(caster.normal, map.away.xyz));
    bool plain = caster.normal == vec3(0.0);  // it faces the light
    if (!plain && abs(normal.z) <= kSkyEdgeOn) return;
    vec3 place = sky_place(map, caster.position);
    if (place.z > map.farthest + caster.radius) return;
    ivec2 columns = range(place.x, disc_reach(caster.radius, normal.x) / size.x, map.columns);
    ivec2 rows = range(place.y, disc_reach(caster.radius, normal.y) / size.y, map.rows);
    vec2 slope = plain ? vec2(0.0) : normal.xy / normal.z;
    vec3 facing = plain ? -map.away.xyz : normal.z > 0.0 ? caster.normal : -caster.normal;
    uint surface = map_surface(caster.radius, facing);
    for (int y = rows.x; y <= rows.y; ++y)
        for (int x = columns.x; x <= columns.y; ++x) {
            vec2 apart = (vec2(x, y) + 0.5 - place.xy) * size;
            float deeper = dot(slope, apart);
            if (dot(apart, apart) + deeper * deeper > caster.radius * caster.radius) continue;
            atomicMin(texels[sky_texel_index(map, vec2(x, y))], pack_sky_texel(place.z + deeper, depth_step, surface));
        }
}
