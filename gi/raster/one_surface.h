// Whether two texels of a G-buffer show one surface, and what follows for the rims of surfaces, shared by C++
// and GLSL.
#ifndef LUCARNE_GI_RASTER_ONE_SURFACE_H
#define LUCARNE_GI_RASTER_ONE_SURFACE_H

#include "gi/raster/blend_weights.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::raster {
#endif

// Rims are seen at a low angle: the largest cosine of the angle between their normal and the ray.
LUCARNE_CONST float kCosRim = 0.5f;  // 60 degrees
// A rim looks for its surface so many pixels away, in eight directions.
LUCARNE_CONST uint kRimSteps = 3u;  // 1, 2 and 4 pixels
LUCARNE_CONST int kRimReach = 4;    // the last of these

// Returns the normal of a texel as its surfels store it: the two sides of a thin wall have opposite ones.
LUCARNE_FN vec3 stored_normal(GBufferTexel texel) {
    vec3 normal = texel_normal(texel);
    return (texel.albedo & kTexelFromBehind) != 0u ? -normal : normal;
}

// Returns whether two texels show one smooth surface: no crease lies between their normals, and each point
// lies in the slab of blending about the other's plane. `normal`: the stored one of a; `across` leads from
// one point to the other, m; `reach`: by which a surface may bend away between the two pixels, m.
LUCARNE_FN bool is_one_surface(GBufferTexel a, vec3 normal, GBufferTexel b, vec3 across, float reach) {
    if (((a.material ^ b.material) & 0xffffu) != 0u || ((a.albedo ^ b.albedo) & kSurfelHasNormal) != 0u)
        return false;
    float most = kSlab * max(texel_radius(a), texel_radius(b)) + reach;
    if (!(abs(dot(normal, across)) <= most)) return false;
    vec3 other = stored_normal(b);
    return dot(normal, other) > kCosCrease && abs(dot(other, across)) <= most;
}

// Returns whether a texel seen from behind lies on a face that another texel's surface hides: where two faces
// of a solid meet, discs of the hidden face may stand out beyond the line at which those of the face in front
// end, by the noise of the points. It lies within a disc's radius of that face, across a crease, and no
// farther in small pictures. The other side of a thin sheet is no hidden face. Arguments as for
// is_one_surface, `normal` that of `behind`.
LUCARNE_FN bool is_over_crease(GBufferTexel behind, vec3 normal, GBufferTexel front, vec3 across,
                               float reach) {
    if (((behind.material ^ front.material) & 0xffffu) != 0u || (front.albedo & kSurfelHasNormal) == 0u ||
        (behind.albedo & kTexelFromBehind) == 0u || (front.albedo & kTexelFromBehind) != 0u)
        return false;
    float radius = max(texel_radius(behind), texel_radius(front));
    float most = radius + 2.0f * reach;
    vec3 other = texel_normal(front);
    return abs(dot(normal, other)) <= kCosCrease && abs(dot(other, across)) <= radius &&
           dot(across, across) <= most * most;
}

// Returns whether a texel shows what is behind another: a surface clearly deeper, seen from the front.
// `reach` as for is_one_surface.
LUCARNE_FN bool is_background(GBufferTexel back, GBufferTexel texel, float reach) {
    return (back.albedo & kTexelFromBehind) == 0u && (back.albedo & kSurfelHasNormal) != 0u &&
           back.depth > texel.depth + 2.0f * texel_radius(texel) + reach;
}

// Returns how much deeper than a place its ray meets the plane of a texel, m. `normal`: of the texel;
// `across` leads from the place to the texel's point, m; `ray`: with depth 1. -infinity if the ray nearly
// misses the plane, or meets it from behind.
LUCARNE_FN float depth_to_plane(vec3 normal, vec3 across, vec3 ray) {
    float slope = dot(normal, ray);
    return slope < -0.1f ? dot(normal, across) / slope : uintBitsToFloat(0xff800000u);
}

// Returns whether a texel is seen at so low an angle that it may be a rim. `ray`: unit, from the eye.
LUCARNE_FN bool may_be_rim(GBufferTexel texel, vec3 ray) {
    return dot(texel_normal(texel), ray) >= -kCosRim;
}
// By which the normal of a rim leans toward the viewer, so that it does not face away once it is rounded to
// 16 bits: such a texel would reflect nothing.
LUCARNE_CONST float kRimLean = 1e-3f;

// Returns the normal of a rim: that of the side away from the viewer, turned until it stands nearly at right
// angles to the ray (unit).
LUCARNE_FN vec3 rim_normal(GBufferTexel texel, vec3 ray) {
    vec3 normal = texel_normal(texel);
    vec3 turned = dot(normal, ray) * ray - normal;
    return normalize(turned * inversesqrt(max(dot(turned, turned), 1e-12f)) - kRimLean * ray);
}

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
