#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/surfel_code.h"
#include "gi/engines/vpl/shadow_maps/thinning.glsl"

// The parabolic map of the hemisphere of a VPL (Brabec, Annen, Seidel 2002), and the layout of the atlas of all maps.
//
// In the frame of the VPL (z is its normal) a direction w has the map coordinates (u, v) = w.xy / (1 + w.z). This is
// the stereographic projection: it is conformal, the hemisphere is the unit disc, and d_omega = 4 / (1 + u^2 + v^2)^2
// du dv.

layout(std430, binding = kBindAtlas) buffer Atlas { uint atlas[]; };

uniform uint map_side;  // texels along a side of a map; maps lie one after the other

// An atlas texel: distance along the texel's central ray | radius of the surfel | normal of its disc, 16 + 4 + 12
// bits. The smallest code is the nearest.
//   distance: a float from 2^-16 to 2^16 m with 11 bits of mantissa (steps of .05 %)
//   radius:   2^(code - 11) m
//   normal:   octahedral, 2 x 6 bits (off by up to 2 degrees), in the VPL's frame, toward the VPL

uint map_surface(float radius, vec3 normal) {
    uint code = uint(clamp(log2(radius) + 11.5, 0.0, 15.0));
    uvec2 steps = uvec2(unpackSnorm2x16(encode_octahedral(normal)) * 31.5 + 31.999);
    return code << 12 | steps.y << 6 | steps.x;
}
uint pack_map_texel(float distance_m, uint surface) {
    float inside = clamp(distance_m, 1.6e-5, 65000.0);
    return ((floatBitsToUint(inside) >> 12) - (111u << 11)) << 16 | surface;
}
float map_distance(uint texel) { return uintBitsToFloat(((texel >> 16) + (111u << 11)) << 12 | 0x800u); }
float map_radius(uint texel) { return exp2(float(texel >> 12 & 15u) - 11.0); }
vec3 map_normal(uint texel) {
    vec2 p = (vec2(texel & 63u, texel >> 6 & 63u) - 31.5) / 31.5;
    return decode_octahedral(packSnorm2x16(p));
}

float splat_radius(float surfel_radius, float distance_m) { return max(surfel_radius, splat_angle * distance_m); }

// How far the disc of a splat that grew to stand in for its neighbours may deviate from their surface, over its
// radius: .05 for a normal that is wrong by 3 degrees, .05 for a surface with a radius of curvature of ten times its
// radius.
const float kSheetTolerance = 0.1;

// Returns how far the disc of a splat may lie beside the surface that it stands for, m.
float splat_error(float surfel_radius, float distance_m) {
    return kSheetTolerance * splat_radius(surfel_radius, distance_m);
}

// Returns the width of a texel at a distance, m (a map shows 2 pi sr in pi/4 side^2 texels).
float texel_width(float distance_m) { return sqrt(8.0) / float(map_side) * distance_m; }

// Returns the distance below which a map cannot separate two surfaces: the error of a splat plus the width of a texel.
float map_tolerance(float surfel_radius, float distance_m) {
    return splat_error(surfel_radius, distance_m) + texel_width(distance_m);
}

// Returns an orthonormal frame about a unit vector (Duff et al. 2017); columns: tangent, bitangent, normal.
mat3 frame_about(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// Returns the direction of map coordinates, times (1 + u^2 + v^2): cheaper than a unit vector, and sufficient for a
// ray.
vec3 map_ray(vec2 uv) { return vec3(2.0 * uv, 1.0 - dot(uv, uv)); }
vec2 map_coordinates(vec3 unit_direction) { return unit_direction.xy / (1.0 + unit_direction.z); }

vec2 texel_centre(uvec2 texel) { return (2.0 * vec2(texel) + 1.0) / float(map_side) - 1.0; }
uvec2 texel_at(vec2 uv) {
    return uvec2(clamp((uv * 0.5 + 0.5) * float(map_side), vec2(0.0), vec2(float(map_side) - 1.0)));
}
uint texel_index(uint map, uvec2 texel) { return (map * map_side + texel.y) * map_side + texel.x; }
