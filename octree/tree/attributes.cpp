#include "octree/tree/attributes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lucarne::octree {
namespace {

// The codes of -1, 0 and 1 are multiples of kMostRounding apart, so rounding leaves normals along the axes
// unchanged.
constexpr int kCentre = 2048, kReach = 63 * kMostRounding;
static_assert(kCentre + kReach < 4095 && kCentre > kReach, "12 bits; 4095 is left for kNoNormal");

constexpr long kMostAreaCode = 0xff80;  // so that rounding stays below kNoArea

glm::vec2 fold(const glm::vec3& n) {
    const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    glm::vec2 p(n.x / sum, n.y / sum);
    if (n.z < 0)
        p = {(1 - std::abs(p.y)) * (p.x >= 0 ? 1.0f : -1.0f),
             (1 - std::abs(p.x)) * (p.y >= 0 ? 1.0f : -1.0f)};
    return p;
}

glm::vec3 unfold(glm::vec2 p) {
    glm::vec3 n(p.x, p.y, 1 - std::abs(p.x) - std::abs(p.y));
    const float t = std::max(-n.z, 0.0f);
    n.x += n.x >= 0 ? -t : t;
    n.y += n.y >= 0 ? -t : t;
    return glm::normalize(n);
}

}  // namespace

NormalCode encode_normal(const glm::vec3& n) {
    const float length2 = glm::dot(n, n);
    if (!(length2 > 0) || !std::isfinite(length2)) return kNoNormal;
    const glm::vec2 p = fold(n);
    const auto quantise = [](float v) {
        return static_cast<uint32_t>(kCentre + std::lround(std::clamp(v, -1.0f, 1.0f) * kReach));
    };
    const uint32_t word = quantise(p.x) | quantise(p.y) << 12;
    return {static_cast<uint8_t>(word), static_cast<uint8_t>(word >> 8), static_cast<uint8_t>(word >> 16)};
}

std::optional<glm::vec3> decode_normal(NormalCode code) {
    if (code == kNoNormal) return std::nullopt;
    const uint32_t word =
        code[0] | static_cast<uint32_t>(code[1]) << 8 | static_cast<uint32_t>(code[2]) << 16;
    const auto coordinate = [](uint32_t q) {
        return std::clamp(static_cast<float>(static_cast<int>(q) - kCentre) / kReach, -1.0f, 1.0f);
    };
    return unfold({coordinate(word & 0xfff), coordinate(word >> 12)});
}

NormalCode round_normal(NormalCode code, int step) {
    if (code == kNoNormal) return code;
    const uint32_t word = code[0] | code[1] << 8 | code[2] << 16;
    const auto nearest = [step](uint32_t q) {
        const int from_centre = static_cast<int>(q) - kCentre, half = from_centre < 0 ? -step / 2 : step / 2;
        return static_cast<uint32_t>(kCentre + (from_centre + half) / step * step);
    };
    const uint32_t rounded = nearest(word & 0xfff) | nearest(word >> 12) << 12;
    return {static_cast<uint8_t>(rounded), static_cast<uint8_t>(rounded >> 8),
            static_cast<uint8_t>(rounded >> 16)};
}

uint16_t round_area(uint16_t code, int step) {
    return code == kNoArea ? code : static_cast<uint16_t>((code + step / 2) / step * step);
}

uint16_t encode_area(double area, double root_size) {
    const double octaves = std::log2(root_size * root_size / area);
    if (!(area > 0) || !std::isfinite(octaves)) return kNoArea;
    return static_cast<uint16_t>(std::clamp(std::lround(octaves * 1024), 0l, kMostAreaCode));
}

double decode_area(uint16_t code, double root_size) {
    return code == kNoArea ? 0.0 : root_size * root_size * std::exp2(-code / 1024.0);
}

}  // namespace lucarne::octree
