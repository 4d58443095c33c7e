#include "gi/engines/vpl/shadow_maps/splats.h"
#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/frame.h"
#include "gi/engines/vpl/shadow_maps/thinning.glsl"

// The parabolic map of the hemisphere of a VPL (Brabec, Annen, Seidel 2002), and the layout of the atlas of all maps.
// texel.h has the texels.
//
// In the frame of the VPL (z is its normal) a direction w has the map coordinates (u, v) = w.xy / (1 + w.z). This is
// the stereographic projection: it is conformal, the hemisphere is the unit disc, and d_omega = 4 / (1 + u^2 + v^2)^2
// du dv.

layout(std430, binding = kBindAtlas) buffer Atlas { uint atlas[]; };

uniform uint map_side;  // texels along a side of a map; maps lie one after the other

float splat_radius(float surfel_radius, float distance_m) { return max(surfel_radius, splat_angle * distance_m); }

// Returns how far the disc of a splat may lie beside the surface that it stands for, m.
float splat_error(float surfel_radius, float distance_m) {
    return kSheetTolerance * splat_radius(surfel_radius, distance_m);
}

// Returns the width of a texel at a distance, m.
float texel_width(float distance_m) { return map_texel_angle(float(map_side)) * distance_m; }

// Returns the distance below which a map cannot separate two surfaces: the error of a splat plus the width of a texel.
float map_tolerance(float surfel_radius, float distance_m) {
    return splat_error(surfel_radius, distance_m) + texel_width(distance_m);
}

// Returns an orthonormal frame about a unit vector; columns: tangent, bitangent, normal.
mat3 frame_about(vec3 n) {
    vec3 tangent, bitangent;
    frame_about(n, tangent, bitangent);
    return mat3(tangent, bitangent, n);
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
