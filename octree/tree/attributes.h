#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// Estimated unit normals as two 12-bit octahedral coordinates in three bytes (Meyer et al. 2010; largest
/// error .06 degrees, far under the .3 degrees and more that an estimate over scan noise has). 0xff 0xff 0xff
/// marks a point without a stable plane.
using NormalCode = std::array<uint8_t, 3>;
inline constexpr NormalCode kNoNormal = {0xff, 0xff, 0xff};
NormalCode encode_normal(const glm::vec3& unit_normal);   ///< zero or non-finite vectors give kNoNormal
std::optional<glm::vec3> decode_normal(NormalCode code);  ///< empty for kNoNormal

/// The largest steps to which codes are rounded where estimates are noisy: 2 degrees at worst for normals
/// (.06 a step), an eighth of an octave for areas.
inline constexpr int kMostRounding = 32, kMostAreaRounding = 128;
/// The code nearest to one of encode_normal or encode_area on a grid of every `step`th, a power of two up to
/// kMostRounding or kMostAreaRounding.
NormalCode round_normal(NormalCode code, int step);
uint16_t round_area(uint16_t code, int step);

/// A point's surface share at full resolution on a logarithmic scale: area = s^2 * 2^(-code/1024), s the root
/// cube's size, so .07 % a step over 63 octaves. The largest code says "unknown".
inline constexpr uint16_t kNoArea = 0xffff;
uint16_t encode_area(double area, double root_size);  ///< clamps; non-positive or non-finite give kNoArea
double decode_area(uint16_t code, double root_size);  ///< 0 for kNoArea

}  // namespace lucarne::octree
