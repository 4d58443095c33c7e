// Splats the surfels of the light cut into the VPLs' imperfect shadow maps (Ritschel et al. 2008).
//
// Not every surfel enters every map: seen from the VPL at distance d it does with probability
//   p = min(1, (r / (splat_angle d))^2),
// and where it does it stands for the 1/p surfels that did not, so that its disc grows to r / sqrt(p), which is
// splat_angle d. All splats of a map are thus about as large (in texels), however far their surface is, and none is
// coarser than the map can show: neither a flat share of the surfels a map (coarse splats close to the VPL) nor all
// of them (256M pairs a frame). Who enters is decided by a hash of the surfel's id: the index modulo M would alias
// with the octree's order.
//
// Per texel the texel's central ray is intersected with the disc's plane: one flat depth a splat would shadow its own
// surface.
layout(local_size_x = 256) in;

#include "gi/shared/cut.glsl"
#include "gi/vpl/clusters.glsl"
#include "gi/vpl/parabolic.glsl"

uniform uint seed;

// Disc area over surface. A random pattern leaves e^-C of the rays through: .7 % at 5, most of them holes of one
// texel that pull-push closes. Larger discs overhang the edges of objects further.
const float kCoverage = 5.0;

uint hash(uint x) {  // "lowbias32" (Wellons 2018)
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

float uniform_of(uint bits) { return (float(bits >> 8) + 0.5) / 16777216.0; }  // in (0, 1)

struct Caster {
    vec3 position, normal;
    bool has_normal;
    float radius;  // of its disc where every surfel enters
    uint id;
};

struct Disc {
    vec3 centre;  // in the VPL's frame, the VPL at the origin
    vec3 normal;
    float radius;
    float surfel_radius;
    float lowest;  // hits up to this height over the VPL's tangent plane do not count
};

void splat(uint map, Disc disc) {
    float distance2 = dot(disc.centre, disc.centre);
    // The cone about the disc's bounding sphere becomes a circle in the map, for the projection is stereographic.
    // `opposite` is 0 where the cone holds the map's pole at infinity: then the circle is the whole map.
    float sine2 = min(disc.radius * disc.radius / distance2, 1.0);
    float opposite = disc.centre.z * inversesqrt(distance2) + sqrt(1.0 - sine2);
    vec2 low = vec2(-1.0), high = vec2(1.0);
    if (opposite > 0.0 && sine2 < 1.0) {
        vec2 middle = disc.centre.xy * inversesqrt(distance2) / opposite;
        float reach = sqrt(sine2) / opposite;
        low = max(middle - reach, low);
        high = min(middle + reach, high);
    }
    // Texels whose centre lies between low and high.
    ivec2 first = ivec2(ceil((low * 0.5 + 0.5) * float(map_side) - 0.5));
    ivec2 last = min(ivec2(floor((high * 0.5 + 0.5) * float(map_side) - 0.5)), ivec2(map_side) - 1);
    first = max(first, ivec2(0));

    float offset = dot(disc.normal, disc.centre);
    float radius2 = disc.radius * disc.radius;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 uv = texel_centre(uvec2(x, y));
            vec3 ray = map_ray(uv);
            float t = offset / dot(disc.normal, ray);
            vec3 hit = t * ray;
            vec3 from_centre = hit - disc.centre;
            if (!(t > 0.0 && dot(from_centre, from_centre) <= radius2 && hit.z > disc.lowest)) continue;
            uint value = pack_map_texel(t * (1.0 + dot(uv, uv)), disc.surfel_radius);
            uint index = texel_index(map, uvec2(x, y));
            if (value < atlas[index]) atomicMin(atlas[index], value);  // the read spares most of the atomics
        }
    }
}

struct Caster {
    vec3 position, normal;
    bool has_normal;
    float radius;
    uint id;
};

// Walks through the maps that a surfel enters: over the clusters, and inside one over its VPLs by skips of geometric
// length. Those are trials with the largest p that the cluster's sphere allows, of which p_VPL / p_largest are kept.
struct Walk {
    uint cluster;
    uint place;     // of the next VPL in the cluster; kClusterLights: go on to the next cluster
    float largest;  // p of the nearest point of the cluster's sphere
    uint random;
};

float entry_probability(float radius, float distance_m) {
    float share = radius / (splat_angle * max(distance_m, 1e-6));
    return min(share * share, 1.0);
}

void enter_cluster(inout Walk walk, Caster caster) {
    vec4 sphere = clusters[walk.cluster];
    walk.largest = 0.0;
    if (sphere.w >= 0.0) walk.largest = entry_probability(caster.radius, distance(sphere.xyz, caster.position) - sphere.w);
    walk.random = hash(caster.id ^ hash(walk.cluster ^ seed));
    walk.place = 0u;
}

// How many VPLs fail their trial before one succeeds: log(u) / log(1 - p).
uint failures(float p, float u) {
    if (p >= 1.0) return 0u;
    return uint(min(log2(u) / min(log2(1.0 - p), -1e-7), float(kClusterLights)));
}

// The disc that `caster` becomes in the map of `light`; false where none of it can be hit.
bool disc_over(VplLight light, Caster caster, out Disc disc) {
    vec3 offset = caster.position - light.position.xyz;
    float distance_m = length(offset);
    vec3 normal = caster.has_normal ? caster.normal : -offset / distance_m;
    float radius = splat_radius(caster.radius, distance_m);
    float cosine = dot(light.normal.xyz, normal);
    // What is nearly parallel to the VPL's surface and hardly above it is the VPL's own sheet.
    float lowest = abs(cosine) > 0.5 ? sheet_tolerance(caster.radius, distance_m) : 0.0;
    float top = dot(light.normal.xyz, offset) + radius * sqrt(max(1.0 - cosine * cosine, 0.0));
    mat3 frame = frame_about(light.normal.xyz);
    disc = Disc(offset * frame, normal * frame, radius, caster.radius, lowest);
    return top > lowest;
}

// The next map that the surfel enters and its disc there; false where there is none left.
bool next_splat(inout Walk walk, Caster caster, out uint map, out Disc disc) {
    uint cluster_count = (maps + kClusterLights - 1u) / kClusterLights;
    for (;;) {
        if (walk.place >= kClusterLights) {
            if (++walk.cluster >= cluster_count) return false;
            enter_cluster(walk, caster);
        }
        walk.place = walk.largest > 0.0 ? walk.place + failures(walk.largest, uniform_of(walk.random)) : kClusterLights;
        map = walk.cluster * kClusterLights + walk.place;
        if (walk.place >= kClusterLights || map >= maps) {
            walk.place = kClusterLights;
            continue;
        }
        ++walk.place;
        VplLight light = lights[map];
        float p = entry_probability(caster.radius, distance(light.position.xyz, caster.position));
        float u = uniform_of(hash(walk.random));
        walk.random = hash(walk.random + 0x9e3779b9u);
        if (is_alive(light) && u * walk.largest < p && disc_over(light, caster, disc)) return true;
    }
}

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    if (!cut_surfel(id, item, surfel)) return;
    Caster caster = Caster(surfel_position(item, surfel), surfel_normal(surfel), surfel_has_normal(surfel),
                           sqrt(kCoverage / 3.14159265 * cut_surfel_area(item, surfel)), id);
    Walk walk = Walk(0xffffffffu, kClusterLights, 0.0, 0u);
    uint map;
    Disc disc;
    while (next_splat(walk, caster, map, disc)) splat(map, disc);
}
