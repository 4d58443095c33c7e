#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// An estimated unit normal as two 12-bit octahedral coordinates in three bytes (Meyer et al. 2010). The
/// largest error is .06 degrees, far below the error of an estimate over scan noise (.3 degrees and more).
/// 0xff 0xff 0xff marks a point without a stable plane.
using NormalCode = std::array<uint8_t, 3>;
inline constexpr NormalCode kNoNormal = {0xff, 0xff, 0xff};
NormalCode encode_normal(const glm::vec3& unit_normal);   ///< zero or non-finite vectors give kNoNormal
std::optional<glm::vec3> decode_normal(NormalCode code);  ///< empty for kNoNormal

/// The largest grid steps to which the codes of noisy estimates are rounded. Normals are then off by at most
/// 2 degrees (.06 degrees per step of 1); areas lie on a grid of an eighth of an octave.
inline constexpr int kMostRounding = 32, kMostAreaRounding = 128;
/// Rounds a code of encode_normal or encode_area to the nearest multiple of `step`, which is a power of two
/// up to kMostRounding or kMostAreaRounding. Normals are counted from the centre of the code.
NormalCode round_normal(NormalCode code, int step);
uint16_t round_area(uint16_t code, int step);

/// A point's share of the surface at full resolution on a logarithmic scale: area = s^2 * 2^(-code/1024),
/// where s is the root cube's size. A step is .07 %, and the codes span 63 octaves. The largest code means
/// "unknown".
inline constexpr uint16_t kNoArea = 0xffff;
uint16_t encode_area(double area, double root_size);  ///< clamps; non-positive or non-finite give kNoArea
double decode_area(uint16_t code, double root_size);  ///< 0 for kNoArea

}  // namespace lucarne::octree
