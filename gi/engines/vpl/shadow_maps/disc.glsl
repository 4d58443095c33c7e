// A surfel as a disc in the shadow map of a VPL, and how it takes texels of the map.
//
// For each texel the plane of the disc is intersected with the central ray of the texel. With a single depth per
// splat, a surface would shadow itself.
#include "gi/engines/vpl/shadow_maps/casters.glsl"
#include "gi/engines/vpl/shadow_maps/fringe.glsl"
#include "gi/engines/vpl/lights.glsl"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"
#include "gi/engines/vpl/shadow_maps/queue.glsl"
#include "gi/engines/vpl/shadow_maps/thinning.glsl"
#include "gi/shared/disc.h"

struct MapDisc {
    vec3 centre;  // in the frame of the VPL, relative to the centre of its map
    vec3 normal;
    float radius;
    float surfel_radius;
    float core;  // radius within which there is certainly surface; the rest is the fringe
    float lowest;  // hits up to this height over the tangent plane of the VPL do not count
};

// Computes the disc of `caster` in the map of VPL `map`. Returns false if no part of it can be hit.
bool disc_over(uint map, Caster caster, out MapDisc disc) {
    vec3 light_normal = vpl_normal(map).xyz;
    vec3 offset = caster.position - vpl_map_centre(map);
    float distance2 = max(dot(offset, offset), 1e-12);
    float distance_m = sqrt(distance2);
    if (caster.normal == vec3(0.0)) caster.normal = -offset / distance_m;
    float radius = thinned_radius(caster.radius, distance_m, abs(dot(caster.normal, offset)) / distance_m);
    float cosine = dot(light_normal, caster.normal);
    // What lies no higher is the VPL's own sheet.
    float lowest = abs(cosine) > kOwnSheet ? kSheetTolerance * radius : 0.0;
    float top = dot(light_normal, offset) + disc_reach(radius, cosine);
    mat3 frame = frame_about(light_normal);
    float core = max(caster.radius, kCore * radius);
    disc = MapDisc(offset * frame, caster.normal * frame, radius, caster.radius, core, lowest);
    return top > lowest;
}

// Computes the texels whose centres the disc may cover, first to last; there are none if first exceeds last. The cone
// about the bounding sphere of the disc becomes a circle in the map, because the projection is stereographic.
void map_box(MapDisc disc, out ivec2 first, out ivec2 last) {
    float inverse = inversesqrt(dot(disc.centre, disc.centre));
    float sine = min(disc.radius * inverse, 1.0);
    // 0 if the cone contains the pole of the map at infinity; then the circle is the whole map.
    float opposite = disc.centre.z * inverse + sqrt(1.0 - sine * sine);
    vec2 low = vec2(-1.0), high = vec2(1.0);
    if (opposite > 0.0 && sine < 1.0) {
        vec2 middle = disc.centre.xy * inverse / opposite;
        float reach = sine / opposite;
        low = max(middle - reach, low);
        high = min(middle + reach, high);
    }
    first = max(ivec2(ceil((low * 0.5 + 0.5) * float(map_side) - 0.5)), ivec2(0));
    last = min(ivec2(floor((high * 0.5 + 0.5) * float(map_side) - 0.5)), ivec2(map_side) - 1);
}

#ifdef LUCARNE_SOURCES
#include "gi/engines/vpl/shadow_maps/sources.glsl"
#endif

// The intersection of the central ray of a texel with the disc.
struct Hit {
    float t;  // distance along the ray over (1 + u^2 + v^2); 0 if the ray misses the disc
    bool core;
};
Hit map_hit(MapDisc disc, vec2 uv) {
    vec3 ray = map_ray(uv);
    DiscHit hit = meet_disc(disc.centre, disc.normal, ray);
    bool met = hit.t > 0.0 && on_disc(hit, disc.radius) && hit.t * ray.z > disc.lowest;
    return Hit(met ? hit.t : 0.0, on_disc(hit, disc.core));
}

void take_core(uvec2 pair, uint index, float distance_m, uint surface) {
    atomicMin(atlas[index], pack_map_texel(distance_m, surface));
#ifdef LUCARNE_SOURCES
    atomicMin(sources[index], pack_source(distance_m, pair.x));
#endif
}
void take_fringe(uvec2 pair, uint index, float distance_m, uint surface) {
    atomicMin(fringe[index], pack_map_texel(distance_m, surface));
#ifdef LUCARNE_SOURCES
    atomicMin(fringe_sources[index], pack_source(distance_m, pair.x));
#endif
}

// Returns the code of the surface, which all texels of a disc share.
uint disc_surface(MapDisc disc) {
    return map_surface(disc.surfel_radius, dot(disc.normal, disc.centre) > 0.0 ? -disc.normal : disc.normal);
}
