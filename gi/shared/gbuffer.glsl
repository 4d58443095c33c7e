// Reading G-buffer texels and the rays of a view.
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/surfel_code.h"

// The ray through a point of the picture in pixels (pixel centres at .5): dot(ray, forward) = 1.
vec3 view_ray(CameraView view, vec2 at) {
    vec2 ndc = 2.0 * at / vec2(view.width, view.height) - 1.0;
    return view.forward.xyz + view.right.xyz * ndc.x - view.up.xyz * ndc.y;
}
vec3 texel_position(CameraView view, uvec2 pixel, GBufferTexel texel) {
    return view.origin.xyz + texel.depth * view_ray(view, vec2(pixel) + 0.5);
}
vec3 texel_normal(GBufferTexel texel) { return decode_octahedral(texel.normal); }
vec3 texel_albedo(GBufferTexel texel) { return decode_albedo(texel.albedo); }
uint texel_material(GBufferTexel texel) { return texel.material & 0xffffu; }
float texel_radius(GBufferTexel texel) { return unpackHalf2x16(texel.material).y; }
