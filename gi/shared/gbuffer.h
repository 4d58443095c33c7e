// The G-buffer's texel and what it holds, for C++, GLSL (std430) and OpenCL C: one buffer of width * height
// of them, row 0 on top.
#ifndef LUCARNE_GI_SHARED_GBUFFER_H
#define LUCARNE_GI_SHARED_GBUFFER_H

#include "gi/shared/camera.h"
#include "gi/shared/language.h"
#include "gi/shared/surfel_code.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_STRUCT(GBufferTexel) {
    float depth;    // along the camera's forward axis, m; 0: empty
    uint normal;    // octahedral 2 x 16 bit, turned toward the viewer (a surfel is an opaque sheet with two
                    // equal sides); surfels without a normal face the viewer
    uint albedo;    // as PackedSurfel.d: sRGB-coded 3 x 10 bit | flags, with kTexelFromBehind
    uint material;  // index | radius of the surfel as a half float << 16
};

// Flag in GBufferTexel.albedo: the normal of the surfel points away from the viewer and was turned.
LUCARNE_CONST uint kTexelFromBehind = 0x80000000u;

// Where discs of one surface overlap, the disc with the nearest centre shall take the pixel; otherwise the
// noise of their planes would decide. So discs are ordered by the depth of their plane, pushed back by this
// share of the radius times (distance from the centre / radius)^2. A disc may therefore show where it sticks
// out of another surface by up to this share of its radius, and no further.
LUCARNE_CONST float kRimPush = 0.25f;

// Returns the point that the texel of a pixel shows.
LUCARNE_FN vec3 texel_position(CameraView view, vec2 pixel, GBufferTexel texel) {
    return view_point(view, pixel + 0.5f, texel.depth);
}
LUCARNE_FN vec3 texel_normal(GBufferTexel texel) {
    return decode_octahedral(texel.normal);
}
LUCARNE_FN vec3 texel_albedo(GBufferTexel texel) {
    return decode_albedo(texel.albedo);
}
LUCARNE_FN uint texel_material(GBufferTexel texel) {
    return texel.material & 0xffffu;
}
LUCARNE_FN float texel_radius(GBufferTexel texel) {
    return unpackHalf2x16(texel.material).y;
}

#ifdef __cplusplus
static_assert(sizeof(GBufferTexel) == 16);
}  // namespace lucarne::gi
#endif
#endif
