// The texels of the atlas and of its half resolution, shared by C++ and GLSL. native/texel-inl.h has the
// codec for vectors.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_TEXEL_H
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_TEXEL_H

#include "gi/shared/language.h"
#include "gi/shared/surfel_code.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// A texel without a surface, or without a source (sources.glsl).
LUCARNE_CONST uint kNothing = 0xffffffffu;
// A coarse texel at the edge of an opening: neither a sheet nor a hole.
LUCARNE_CONST uint kOpen = 0xfffffffeu;

// An atlas texel: distance along the texel's central ray | radius of the surfel | normal of its disc, 16 + 4
// + 12 bits. The smallest code is the nearest.
//   distance: a float from 2^-16 to 2^16 m with 11 bits of mantissa (steps of .05 %)
//   radius:   2^(code - 11) m
//   normal:   octahedral, 2 x 6 bits (off by less than 4 degrees), in the VPL's frame, toward the VPL
LUCARNE_CONST float kNearestDistance = 1.6e-5f;
LUCARNE_CONST float kFarthestDistance = 65000.0f;
LUCARNE_CONST uint kDistanceBias = 111u << 11;  // of the exponent, 127 - 16
LUCARNE_CONST uint kHalfStep = 0x800u;          // a distance lies in the middle of its step
LUCARNE_CONST uint kRadiusBias = 116u;          // 127 - 11

LUCARNE_FN uint pack_map_texel(float distance_m, uint surface) {
    float inside = clamp(distance_m, kNearestDistance, kFarthestDistance);
    return ((floatBitsToUint(inside) >> 12) - kDistanceBias) << 16 | surface;
}
LUCARNE_FN uint map_surface(float radius, vec3 normal) {
    uint code = uint(clamp(log2(radius) + 11.5f, 0.0f, 15.0f));
    vec2 steps = unpackSnorm2x16(encode_octahedral(normal)) * 31.5f + 31.999f;
    return code << 12 | uint(steps.y) << 6 | uint(steps.x);
}
LUCARNE_FN float map_distance(uint texel) {
    return uintBitsToFloat(((texel >> 16) + kDistanceBias) << 12 | kHalfStep);
}
LUCARNE_FN float map_radius(uint texel) {
    return uintBitsToFloat(((texel >> 12 & 15u) + kRadiusBias) << 23);
}
LUCARNE_FN vec3 map_normal(uint texel) {
    vec2 p = (vec2(float(texel & 63u), float(texel >> 6 & 63u)) - 31.5f) / 31.5f;
    return decode_octahedral(packSnorm2x16(p));
}

// Returns the width of a texel at a distance of 1, m, of a map with `side` texels along a side: a map shows 2
// pi sr in pi/4 side^2 texels.
LUCARNE_FN float map_texel_angle(float side) {
    return sqrt(8.0f) / side;
}

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
