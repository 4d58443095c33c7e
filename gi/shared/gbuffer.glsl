// Decodes G-buffer texels and computes the rays of a view.
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/surfel_code.h"

bool is_parallel(CameraView view) { return view.projection == kOrthographic; }
// Returns the offset of the picture point `at` (pixels, pixel centres at .5) from the middle of the picture, along
// `right` and `up`.
vec3 view_across(CameraView view, vec2 at) {
    vec2 ndc = view_ndc(view, at);
    return view.right.xyz * ndc.x - view.up.xyz * ndc.y;
}
// Returns the ray through the picture point `at`, scaled so that dot(ray, forward) = 1.
vec3 view_ray(CameraView view, vec2 at) {
    return view.forward.xyz + (is_parallel(view) ? vec3(0.0) : view_across(view, at));
}
vec3 view_start(CameraView view, vec2 at) {
    return view.origin.xyz + (is_parallel(view) ? view_across(view, at) : vec3(0.0));
}
vec3 view_point(CameraView view, vec2 at, float depth) {
    return view_start(view, at) + depth * view_ray(view, at);
}
// Projects a point: returns its place in the picture, in pixels, and sets `depth` to its depth along the forward
// axis, m.
vec2 view_place(CameraView view, vec3 position, out float depth) {
    vec3 offset = position - view.origin.xyz;
    depth = dot(offset, view.forward.xyz);
    vec2 ndc = vec2(dot(offset, view.right.xyz) / dot(view.right.xyz, view.right.xyz),
                    -dot(offset, view.up.xyz) / dot(view.up.xyz, view.up.xyz));
    if (!is_parallel(view)) ndc /= depth;
    return view_pixel(view, ndc);
}
// Returns the height of a pixel at a depth, m.
float pixel_height(CameraView view, float depth) {
    return 2.0 * length(view.up.xyz) / float(view.height) * (is_parallel(view) ? 1.0 : depth);
}
vec3 toward_viewer(CameraView view, vec3 position) {
    return is_parallel(view) ? -view.forward.xyz : normalize(view.origin.xyz - position);
}
vec3 texel_position(CameraView view, uvec2 pixel, GBufferTexel texel) {
    return view_point(view, vec2(pixel) + 0.5, texel.depth);
}
vec3 texel_normal(GBufferTexel texel) { return decode_octahedral(texel.normal); }
vec3 texel_albedo(GBufferTexel texel) { return decode_albedo(texel.albedo); }
uint texel_material(GBufferTexel texel) { return texel.material & 0xffffu; }
float texel_radius(GBufferTexel texel) { return unpackHalf2x16(texel.material).y; }
