// Places the VPLs of the next bounce (Preiner 2010, section 4.5). The shadow map of a VPL shows what its light falls
// on; one of the texels of the map becomes the place of a new VPL. A workgroup a map.
//
// The paper takes the best candidate, which has no probability and therefore gives no unbiased estimate. Here the
// texels race: each draws a time -ln(u) / w, u even on (0, 1), and the earliest wins, with probability w / sum(w) (an
// exponential race; Efraimidis and Spirakis 2006). w is the flux through the texel times the reflectance there. The
// flux of the winner times sum(w) / w then has the whole flux as its mean, with little variance.
// LUCARNE_BEST_CANDIDATE selects the method of the paper.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/groups.h"
#include "gi/shared/cut.glsl"
#include "gi/engines/vpl/redistribution/redistribution.glsl"

layout(local_size_x = kRaceGroup) in;

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindLights) writeonly buffer Next { VplLight next[]; };  // diffuse is still without the flux
layout(std430, binding = kBindWeightSums) writeonly buffer WeightSums { float weight_sums[]; };  // weight sum: sum(w) of a map, W
layout(binding = kUnitSources) uniform usamplerBuffer source_texels;

uniform uint seed, id_bits, first_map;

// Texels without a surfel, and surfels of the VPL's own sheet, hide what the light would reach behind them: the rest of
// the map stands in for them, up to this factor.
const float kMostHidden = 2.0;

shared float shared_key[kRaceGroup], shared_sum[kRaceGroup], shared_all[kRaceGroup], shared_found[kRaceGroup];
shared uint shared_place[kRaceGroup];

float random(uint a, uint b) {  // in (0, 1); a hash after Jarzynski and Olano 2020 (pcg2d)
    uvec2 v = uvec2(a, b) * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16;
    return (float(v.x >> 8) + 0.5) / 16777216.0;
}

// What a texel of a shadow map shows from the VPL.
struct MapRay {
    vec3 direction;     // in the VPL's frame, unit
    float distance_m;   // 0: the texel is empty
    float solid_angle;  // sr, times the cosine at the VPL
};
MapRay look(uint map, uvec2 at) {
    MapRay ray = MapRay(vec3(0.0, 0.0, 1.0), 0.0, 0.0);
    vec2 uv = texel_centre(at);
    float norm2 = dot(uv, uv);
    uint texel = texelFetch(atlas_texels, int(texel_index(map, at))).x;
    if (norm2 >= 1.0 || texel == kNothing) return ray;
    float inverse = 1.0 / (1.0 + norm2);
    ray.direction = map_ray(uv) * inverse;
    ray.distance_m = map_distance(texel);
    float side = 2.0 * inverse * 2.0 / float(map_side);
    ray.solid_angle = side * side * ray.direction.z;
    return ray;
}

// Returns the radiant intensity, W/sr, toward the surface that a texel shows.
vec3 intensity_at(uint map, mat3 frame, MapRay ray) {
    return raced_intensity(map, frame * ray.direction, ray.direction.z, ray.distance_m * ray.distance_m);
}

Reflectance reflectance_of(uint item, PackedSurfel surfel) {
    return make_reflectance(materials[surfel_material(surfel.b)], decode_albedo(surfel.d));
}

// Returns the normal of a surfel on the side that light in a unit direction falls on.
vec3 lit_normal(PackedSurfel surfel, vec3 direction) {
    vec3 normal = surfel_has_normal(surfel) ? surfel_normal(surfel) : -direction;
    return dot(normal, direction) > 0.0 ? -normal : normal;
}

// Returns the share of a VPL's light that shading would count at a surfel which its map shows. Without it the race
// would send light along noisy surfaces, where shading drops it.
float share_of(uint map, uint item, PackedSurfel surfel) {
    vec3 offset = surfel_position(item, surfel) - vpl_position(map).xyz;
    return pair_share(vpl_normal(map).xyz, offset, lit_normal(surfel, normalize(offset)), cut_surfel_radius(item, surfel));
}

void write_light(uint map, uvec2 at, float inverse_probability) {
    mat3 frame = frame_about(vpl_normal(map).xyz);
    MapRay ray = look(map, at);
    uint id = texelFetch(source_texels, int(texel_index(map, at))).x & ((1u << id_bits) - 1u);
    uint item;
    PackedSurfel surfel;
    cut_surfel(id, item, surfel);
    vec3 direction = frame * ray.direction;
    vec3 normal = lit_normal(surfel, direction);
    Reflectance r = reflectance_of(item, surfel);
    float radius = cut_surfel_radius(item, surfel);
    vec3 flux = intensity_at(map, frame, ray) * ray.solid_angle * inverse_probability;
    // The VPL stands in the middle of the surfel, which lies on the scanned surface. At the end of the texel's ray
    // the rim of the disc may stick out, even out of a sealed room.
    next[map] = VplLight(vec4(surfel_position(item, surfel), cut_surfel_area(item, surfel)), vec4(normal, radius),
                         vec4(r.kd / kPi, r.exponent), vec4(flux, 1.0), vec4(-direction, r.ks));
}

void main() {
    uint map = first_map + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    mat3 frame = frame_about(vpl_normal(map).xyz);
    float best = 3e38, sum = 0.0, all = 0.0, found = 0.0;
    uint place = 0u;
    for (uint i = lane; i < map_side * map_side; i += kRaceGroup) {
        uvec2 at = uvec2(i % map_side, i / map_side);
        MapRay ray = look(map, at);
        float flux = luminance(intensity_at(map, frame, ray)) * ray.solid_angle;
        uint source = texelFetch(source_texels, int(texel_index(map, at))).x;
        uint item;
        PackedSurfel surfel;
        float weight = 0.0, arrives = 0.0;
        if (flux > 0.0 && source != kNothing && cut_surfel(source & ((1u << id_bits) - 1u), item, surfel)) {
            arrives = flux * share_of(map, item, surfel);
            weight = arrives * reflected_share(reflectance_of(item, surfel));
        }
        all += flux;
        found += arrives;
        sum += weight;
#ifdef LUCARNE_BEST_CANDIDATE
        float key = weight > 0.0 ? -weight : 3e38;
#else
        float key = weight > 0.0 ? -log(random(seed + map * 9781u, i)) / weight : 3e38;
#endif
        place = key < best ? i : place;
        best = min(best, key);
    }
    shared_key[lane] = best;
    shared_place[lane] = place;
    shared_sum[lane] = sum;
    shared_all[lane] = all;
    shared_found[lane] = found;
    barrier();
    if (lane != 0u) return;
    for (uint i = 1u; i < kRaceGroup; ++i) {
        if (shared_key[i] < best) place = shared_place[i];
        best = min(best, shared_key[i]);
        sum += shared_sum[i];
        all += shared_all[i];
        found += shared_found[i];
    }
    float hidden = found > 0.0 ? min(all / found, kMostHidden) : 0.0;
    weight_sums[map] = sum * hidden;
    next[map] = VplLight(vec4(vec3(1e18), 0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    if (!(sum > 0.0) || best >= 3e38) return;
    uvec2 at = uvec2(place % map_side, place / map_side);
    // 1 / probability of the winner.
    MapRay ray = look(map, at);
    float luminous = luminance(intensity_at(map, frame, ray)) * ray.solid_angle;
    uint item;
    PackedSurfel surfel;
    cut_surfel(texelFetch(source_texels, int(texel_index(map, at))).x & ((1u << id_bits) - 1u), item, surfel);
    float own = luminous * share_of(map, item, surfel) * reflected_share(reflectance_of(item, surfel));
#ifdef LUCARNE_BEST_CANDIDATE
    float scale = all / luminous;
#else
    float scale = sum / own * hidden;
#endif
    write_light(map, at, scale);
}
