// Surfels as discs in the view of these uniforms; gi/shared/disc.h has the discs.
#include "gi/shared/cut.glsl"
#include "gi/shared/disc.h"
#include "gi/shared/gbuffer.h"

uniform vec4 view_right;    // unit; w: tangent of half the field, or half the width (m)
uniform vec4 view_down;     // unit; w: as view_right, along the height
uniform vec4 view_forward;  // unit; w: near plane, m
uniform vec4 view_origin;  // w: 1 if orthographic, else 0
uniform uint view_width;
uniform uint view_height;
uniform vec2 view_shift;  // of the rays from the middles of their pixels, pixels (CameraView)
uniform float point_scale;   // scale of the radii
uniform float point_pixels;  // if over 0: the diameter of all points
uniform float point_most;    // if over 0: the largest diameter of a point, pixels
uniform uint point_front_only;  // if not 0: points whose normals point away from the eye are left out

vec2 pixels_per_tangent() { return vec2(view_width, view_height) / (2.0 * vec2(view_right.w, view_down.w)); }
vec2 pixel_tangent(vec2 pixel) {
    return (2.0 * (pixel + 0.5 + view_shift) / vec2(view_width, view_height) - 1.0) * vec2(view_right.w, view_down.w);
}
// Returns the place of the forward axis in the picture, pixels.
vec2 view_middle() { return 0.5 * vec2(view_width, view_height) - view_shift; }
// Returns the factor by which widths and heights in the view grow with depth.
float view_scale(float depth) { return view_origin.w > 0.0 ? 1.0 : depth; }
vec2 ray_slope(vec2 tangent) { return tangent * (1.0 - view_origin.w); }
// The ray of a pixel in the space of the view.
vec3 disc_ray(vec2 tangent) { return vec3(ray_slope(tangent), 1.0); }
vec3 disc_start(vec2 tangent) { return vec3(tangent * view_origin.w, 0.0); }
vec3 to_view(vec3 v) { return vec3(dot(v, view_right.xyz), dot(v, view_down.xyz), dot(v, view_forward.xyz)); }

// Returns whether one invocation draws the disc; larger ones are drawn by a workgroup each.
bool is_small(ViewDisc disc) {
    vec2 pixels = disc.radius * pixels_per_tangent();
    return max(pixels.x, pixels.y) <= kSmallRadius * view_scale(disc.centre.z);
}

// Returns the radius of a disc at a depth that is drawn with this diameter, in pixels.
float radius_of_pixels(float diameter, float depth) {
    vec2 pixels = pixels_per_tangent();
    return 0.5 * diameter * max(view_scale(depth), 0.0) / min(pixels.x, pixels.y);
}

uint pixel_index(vec2 pixel) { return uint(pixel.y) * view_width + uint(pixel.x); }

// Transforms a surfel to the view. Returns false if no part of its disc is in front of the near plane, for outliers,
// and for what is left out because it faces away.
bool view_disc(uint item, PackedSurfel surfel, out ViewDisc disc) {
    disc.centre = to_view(surfel_position(item, surfel) - view_origin.xyz);
    disc.radius = point_scale * cut_surfel_radius(item, surfel);
    if (!(disc.radius > 0.0)) return false;
    if (point_pixels > 0.0) disc.radius = radius_of_pixels(point_pixels, disc.centre.z);
    else if (point_most > 0.0) disc.radius = min(disc.radius, radius_of_pixels(point_most, disc.centre.z));
    if (!(disc.centre.z + disc.radius > view_forward.w)) return false;
    // Outside a side plane of the view. Without this test a disc beside the eye would cover every pixel.
    vec2 side = vec2(view_right.w, view_down.w);
    vec2 outside = abs(disc.centre.xy) - view_scale(disc.centre.z) * side;
    if (!(view_origin.w > 0.0)) outside *= inversesqrt(1.0 + side * side);
    if (max(outside.x, outside.y) > disc.radius) return false;
    float distance2 = view_origin.w > 0.0 ? 0.0 : dot(disc.centre, disc.centre);
    vec3 toward = distance2 > 0.0 ? disc.centre * inversesqrt(distance2) : vec3(0.0, 0.0, 1.0);
    disc.push = kRimPush * disc.radius * toward.z;  // along the ray
    disc.normal = surfel_has_normal(surfel) ? to_view(surfel_normal(surfel)) : toward;
    if (point_front_only != 0u && surfel_has_normal(surfel) && dot(disc.normal, toward) > 0.0) return false;
    if (point_pixels > 0.0) disc.normal = toward;
    disc.edge = point_pixels > 0.0 ? vec3(0.0) : to_view(surfel_edge(item, surfel));
    disc.extent = disc_reach(disc.radius, disc.normal.z);
    return disc.centre.z + disc.extent > view_forward.w;
}

DiscPicture disc_picture() {
    return DiscPicture(vec2(view_width, view_height), pixels_per_tangent(), view_middle(), view_forward.w,
                       view_origin.w > 0.0);
}
