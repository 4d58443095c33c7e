// Surfels as discs in a view: their projection, and where the ray of a pixel meets them. View space: x right, y down,
// z along the forward axis of the view (the depth), metres. In perspective the ray through a pixel starts at the eye
// and has the direction (x, y, 1); in an orthographic view it starts at (x, y, 0) and has the direction (0, 0, 1).
#include "gi/shared/cut.glsl"
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

struct Disc {
    vec3 centre;
    vec3 normal;
    float radius;
    float extent;  // half the range of depths that it spans, m
    float push;    // by which its rim is pushed back, m of depth
};

const uint kNoKey = 0xffffffffu;

vec2 pixels_per_tangent() { return vec2(view_width, view_height) / (2.0 * vec2(view_right.w, view_down.w)); }
vec2 pixel_tangent(vec2 pixel) {
    return (2.0 * (pixel + 0.5 + view_shift) / vec2(view_width, view_height) - 1.0) * vec2(view_right.w, view_down.w);
}
// Returns the place of the forward axis in the picture, pixels.
vec2 view_middle() { return 0.5 * vec2(view_width, view_height) - view_shift; }
// Returns the factor by which widths and heights in the view grow with depth.
float view_scale(float depth) { return view_origin.w > 0.0 ? 1.0 : depth; }
vec2 ray_slope(vec2 tangent) { return tangent * (1.0 - view_origin.w); }
vec2 ray_start(vec2 tangent) { return tangent * view_origin.w; }
vec3 to_view(vec3 v) { return vec3(dot(v, view_right.xyz), dot(v, view_down.xyz), dot(v, view_forward.xyz)); }

// Discs of a larger radius, in pixels, are drawn by a workgroup each.
const float kSmallRadius = 8.0;
bool is_small(Disc disc) {
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
bool view_disc(uint item, PackedSurfel surfel, out Disc disc) {
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
    disc.extent = disc.radius * sqrt(max(1.0 - disc.normal.z * disc.normal.z, 0.0));
    return disc.centre.z + disc.extent > view_forward.w;
}

// Returns the range of tangents x/z (axis 0) or y/z (axis 1) of a disc in front of the eye: those of the two planes
// through the eye that touch it. With a = (1, 0, -u): (a.c)^2 = r^2 (|a|^2 - (a.n)^2), a quadratic in u.
vec2 tangent_range(float centre, float normal, Disc disc) {
    float r2 = disc.radius * disc.radius;
    if (view_origin.w > 0.0) return centre + disc.radius * sqrt(max(1.0 - normal * normal, 0.0)) * vec2(-1.0, 1.0);
    float a = disc.centre.z * disc.centre.z - disc.extent * disc.extent;
    float b = centre * disc.centre.z + r2 * normal * disc.normal.z;
    float c = centre * centre - r2 * (1.0 - normal * normal);
    float root = sqrt(max(b * b - a * c, 0.0));
    return vec2(b - root, b + root) / a;
}

// Computes the pixels [box.xy, box.zw] whose centres the disc may cover, clipped to the picture. `home` is the pixel
// of the centre of the disc, for which it always competes. Returns false if there are no such pixels.
bool disc_box(Disc disc, out ivec4 box, out ivec2 home) {
    vec2 scale = pixels_per_tangent();
    vec2 middle = view_middle();
    ivec2 last = ivec2(view_width, view_height) - 1;
    home = ivec2(-1);
    if (disc.centre.z > view_forward.w)
        home = ivec2(floor(clamp(disc.centre.xy / view_scale(disc.centre.z) * scale + middle, vec2(-1.0), vec2(last + 1))));
    box = ivec4(ivec2(0), last);
    if (view_origin.w > 0.0 || disc.centre.z > 1.001 * disc.extent) {  // else the disc reaches behind the eye
        vec2 x = tangent_range(disc.centre.x, disc.normal.x, disc);
        vec2 y = tangent_range(disc.centre.y, disc.normal.y, disc);
        vec2 low = vec2(x.x, y.x) * scale + middle, high = vec2(x.y, y.y) * scale + middle;
        box.xy = max(min(ivec2(ceil(clamp(low - 0.5, vec2(-1.0), vec2(last + 1)))), home), ivec2(0));
        box.zw = min(max(ivec2(floor(clamp(high - 0.5, vec2(-1.0), vec2(last + 1)))), home), last);
    }
    return box.x <= box.z && box.y <= box.w;
}

// Returns the depth along the forward axis where the ray meets the plane of the disc, clamped to the depths that the
// disc spans (a plane seen edge-on would put its pixel anywhere).
float disc_depth(Disc disc, vec2 ray) {
    float slope = dot(disc.normal, vec3(ray_slope(ray), 1.0));
    if (abs(slope) < 1e-12) return disc.centre.z;
    float z = dot(disc.normal, disc.centre - vec3(ray_start(ray), 0.0)) / slope;
    return clamp(z, disc.centre.z - disc.extent, disc.centre.z + disc.extent);
}

// Returns the order of the disc along the ray, or kNoKey if the ray misses it. The order is the bits of a positive
// float, so that integers compare like depths. Every pass must compute the same bits: precise.
uint disc_key(Disc disc, vec2 ray, bool at_home) {
    precise float slope = dot(disc.normal, vec3(ray_slope(ray), 1.0));
    precise vec3 centre = disc.centre - vec3(ray_start(ray), 0.0);
    precise float z = dot(disc.normal, centre) / (abs(slope) < 1e-12 ? 1e-12 : slope);
    precise vec3 offset = vec3(ray_slope(ray) * z, z) - centre;
    precise float d2 = dot(offset, offset);
    float r2 = disc.radius * disc.radius;
    bool inside = d2 <= r2;
    if (!inside && !at_home) return kNoKey;
    z = clamp(z, disc.centre.z - disc.extent, disc.centre.z + disc.extent);
    if (!(z > view_forward.w)) return kNoKey;
    precise float key = z + disc.push * (inside && r2 > 0.0 ? d2 / r2 : 1.0);
    return floatBitsToUint(key);
}
