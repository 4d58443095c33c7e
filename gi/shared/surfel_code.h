// Encodes and decodes the fields of a PackedSurfel, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_SURFEL_CODE_H
#define LUCARNE_GI_SHARED_SURFEL_CODE_H

#include "gi/shared/language.h"
#include "gi/shared/surfel.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Octahedral code of unit vectors (Meyer et al. 2010, "On floating-point normal vectors"), two signed 16-bit
// fractions: the largest error is .004 degrees.
LUCARNE_FN uint encode_octahedral(vec3 n) {
    vec2 p = vec2(n.x, n.y) / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z < 0.0f)
        p = vec2((1.0f - abs(p.y)) * (p.x >= 0.0f ? 1.0f : -1.0f),
                 (1.0f - abs(p.x)) * (p.y >= 0.0f ? 1.0f : -1.0f));
    return packSnorm2x16(p);
}
LUCARNE_FN vec3 decode_octahedral(uint code) {
    vec2 p = unpackSnorm2x16(code);
    vec3 n = vec3(p.x, p.y, 1.0f - abs(p.x) - abs(p.y));
    float t = max(-n.z, 0.0f);
    n.x += n.x >= 0.0f ? -t : t;
    n.y += n.y >= 0.0f ? -t : t;
    return n * inversesqrt(dot(n, n));  // |x| + |y| + |z| = 1: never zero
}

// Convert one channel in [0, 1] from sRGB (IEC 61966-2-1) to linear light and back.
LUCARNE_FN float srgb_to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : pow((v + 0.055f) / 1.055f, 2.4f);
}
LUCARNE_FN float linear_to_srgb(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * pow(v, 1.0f / 2.4f) - 0.055f;
}

// Decode and encode a linear Rec. 709 colour in [0, 1] as the 3 x 10 bits of PackedSurfel.d.
LUCARNE_FN vec3 decode_albedo(uint code) {
    return vec3(srgb_to_linear(float(code & 1023u) / 1023.0f),
                srgb_to_linear(float(code >> 10 & 1023u) / 1023.0f),
                srgb_to_linear(float(code >> 20 & 1023u) / 1023.0f));
}

LUCARNE_FN uint encode_albedo(vec3 colour) {
    return uint(linear_to_srgb(colour.x) * 1023.0f + 0.5f) |
           uint(linear_to_srgb(colour.y) * 1023.0f + 0.5f) << 10 |
           uint(linear_to_srgb(colour.z) * 1023.0f + 0.5f) << 20;
}

// Returns the 16-bit fractions of the node's cube; a point lies in the middle of its step.
LUCARNE_CONST float kFractionSteps = 65536.0f;
LUCARNE_FN vec3 surfel_fractions(uint a, uint b) {
    return (vec3(float(a & 0xffffu), float(a >> 16), float(b & 0xffffu)) + 0.5f) / kFractionSteps;
}

// Returns which of the eight octants holds the surfel, `depth` levels below the node.
LUCARNE_FN uint surfel_octant(uint a, uint b, uint depth) {
    uint bit = 15u - depth;
    return (a >> bit & 1u) | (a >> (bit + 16u) & 1u) << 1 | (b >> bit & 1u) << 2;
}
LUCARNE_CONST uint kOctantLevels = 16u;

// Area code of a surfel whose share of the surface is unknown.
LUCARNE_CONST uint kUnknownArea = 255u;
// Area code of an outlier, valid only without a normal: a point known to hang in the air (a mixed pixel). It
// is not drawn and has no share of any surface.
LUCARNE_CONST uint kStrayArea = 254u;
LUCARNE_FN bool surfel_is_stray(uint b, uint d) {
    return (b >> 16 & 255u) == kStrayArea && (d & kSurfelHasNormal) == 0u;
}
// Returns the surfel's own share of the surface in m^2, 0 if unknown. `size` is the side of its node, m.
LUCARNE_FN float surfel_own_area(uint b, float size) {
    uint code = b >> 16 & 255u;
    return code == kUnknownArea ? 0.0f : size * size * exp2(-0.125f * float(code));
}
LUCARNE_FN uint surfel_material(uint b) {
    return b >> 24;
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
