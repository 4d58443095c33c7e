#include "octree/attributes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lucarne::octree {
namespace {

constexpr float kLargest = 4094.0f;  // even, so that 0 is exactly representable; 4095 is left for kNoNormal

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
        return static_cast<uint32_t>(std::lround((std::clamp(v, -1.0f, 1.0f) * 0.5f + 0.5f) * kLargest));
    };
    const uint32_t word = quantise(p.x) | quantise(p.y) << 12;
    return {static_cast<uint8_t>(word), static_cast<uint8_t>(word >> 8), static_cast<uint8_t>(word >> 16)};
}

std::optional<glm::vec3> decode_normal(NormalCode code) {
    if (code == kNoNormal) return std::nullopt;
    const uint32_t word =
        code[0] | static_cast<uint32_t>(code[1]) << 8 | static_cast<uint32_t>(code[2]) << 16;
    const auto coordinate = [](uint32_t q) {
        return std::min(static_cast<float>(q) / kLargest, 1.0f) * 2 - 1;
    };
    return unfold({coordinate(word & 0xfff), coordinate(word >> 12)});
}

uint16_t encode_area(double area, double root_size) {
    const double octaves = std::log2(root_size * root_size / area);
    if (!(area > 0) || !std::isfinite(octaves)) return kNoArea;
    return static_cast<uint16_t>(std::clamp(std::lround(octaves * 1024), 0l, 0xfffel));
}

double decode_area(uint16_t code, double root_size) {
    return code == kNoArea ? 0.0 : root_size * root_size * std::exp2(-code / 1024.0);
}

}  // namespace lucarne::octree
