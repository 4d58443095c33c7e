// Splats the queued pairs of surfel and map into the VPLs' imperfect shadow maps (Ritschel et al. 2008).
//
// Per texel the texel's central ray is intersected with the disc's plane: one flat depth a splat would shadow its own
// surface.
layout(local_size_x = 256) in;

#include "gi/vpl/casters.glsl"
#include "gi/vpl/parabolic.glsl"
#include "gi/vpl/queue.glsl"

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
    uint surface = map_surface(disc.surfel_radius, offset > 0.0 ? -disc.normal : disc.normal);
    if (first.y > last.y) return;
    for (ivec2 at = first; at.x <= last.x;) {  // one loop for both axes: invocations with small discs wait less
        vec2 uv = texel_centre(uvec2(at));
        float norm2 = dot(uv, uv);
        vec3 ray = vec3(2.0 * uv, 1.0 - norm2);
        float t = offset / dot(disc.normal, ray);
        vec3 hit = t * ray;
        vec3 from_centre = hit - disc.centre;
        if (t > 0.0 && dot(from_centre, from_centre) <= radius2 && hit.z > disc.lowest)
            atomicMin(atlas[texel_index(map, uvec2(at))], pack_map_texel(t * (1.0 + norm2), surface));
        at = at.y < last.y ? ivec2(at.x, at.y + 1) : ivec2(at.x + 1, first.y);
    }
}

// The disc that `caster` becomes in the map of `light`; false where none of it can be hit.
bool disc_over(VplLight light, Caster caster, out Disc disc) {
    vec3 offset = caster.position - map_centre(light);
    float distance2 = max(dot(offset, offset), 1e-12);
    float distance_m = sqrt(distance2);
    if (caster.normal == vec3(0.0)) caster.normal = -offset / distance_m;
    float share = splat_share(caster.radius, distance2, abs(dot(caster.normal, offset)));
    float radius = caster.radius * inversesqrt(min(share, 1.0));
    float cosine = dot(light.normal.xyz, caster.normal);
    // What is nearly parallel to the VPL's surface and hardly above the map's centre is the VPL's own sheet.
    float lowest = abs(cosine) > 0.5 ? kSheetTolerance * radius : 0.0;
    float top = dot(light.normal.xyz, offset) + radius * sqrt(max(1.0 - cosine * cosine, 0.0));
    mat3 frame = frame_about(light.normal.xyz);
    disc = Disc(offset * frame, caster.normal * frame, radius, caster.radius, lowest);
    return top > lowest;
}

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place >= queue_count) return;
    uvec2 pair = queue[place];
    Disc disc;
    if (disc_over(lights[pair.y], decode_caster(caster_codes[pair.x]), disc)) splat(pair.y, disc);
}
