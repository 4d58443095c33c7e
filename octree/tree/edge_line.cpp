#include "octree/tree/edge_line.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "octree/tree/edge_turn.h"

namespace lucarne::octree {
namespace {

constexpr float kTurnSteps = 64, kDistanceSteps = 64;
constexpr float kLeastInPlane = 0.1f;     ///< length of a unit direction's projection on the plane
constexpr float kCosSamePlane = 0.9397f;  ///< 20 degrees

}  // namespace

int longest_axis(const glm::vec3& v) {
    const float x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

EdgeCode encode_edge(const glm::vec3& normal, const EdgeLine& line) {
    const glm::vec3 toward = line.toward - normal * glm::dot(normal, line.toward);
    if (!(line.distance <= kFarthestEdge) || !(glm::length(toward) >= kLeastInPlane)) return kNoEdge;
    const int k = longest_axis(normal);
    const float turn = turn_of(toward[(k + 1) % 3], toward[(k + 2) % 3]);
    const long steps = std::lround(turn * kTurnSteps) % 256;
    const long distance = std::clamp(std::lround(line.distance * kDistanceSteps), 1L, 255L);
    return {static_cast<uint8_t>(steps), static_cast<uint8_t>(distance)};
}

std::optional<EdgeLine> decode_edge(const glm::vec3& normal, EdgeCode code) {
    if (code[1] == 0 || normal == glm::vec3(0.0f)) return std::nullopt;
    const int k = longest_axis(normal), a = (k + 1) % 3, b = (k + 2) % 3;
    const float turn = static_cast<float>(code[0]) / kTurnSteps;
    glm::vec3 toward(0.0f);
    toward[a] = turn_u(turn);
    toward[b] = turn_v(turn);
    toward[k] = -(normal[a] * toward[a] + normal[b] * toward[b]) / normal[k];
    return EdgeLine{glm::normalize(toward), static_cast<float>(code[1]) / kDistanceSteps};
}

EdgeCode rebased_edge(EdgeCode code, const EdgeBase& from, const EdgeBase& to) {
    auto line = decode_edge(from.normal, code);
    if (!line || !(from.area > 0) || !(to.area > 0) ||
        !(std::abs(glm::dot(from.normal, to.normal)) >= kCosSamePlane))
        return kNoEdge;
    line->distance = static_cast<float>(line->distance * std::sqrt(from.area / to.area));
    return encode_edge(to.normal, *line);
}

}  // namespace lucarne::octree
