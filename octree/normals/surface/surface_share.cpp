#include "octree/normals/surface/surface_share.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lucarne::octree {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Corners of the cell up to this share of the reach count as known. A corner is the centre of an empty disc
/// of which only a part lies beyond the reach, and in a Poisson pattern such a disc is empty with a chance of
/// e^-10.
constexpr float kKnown = 0.8f;
constexpr float kMostSeen = 2.0f;  ///< in reaches: an open side is half of kLook away
/// How many reaches away the surface is looked for. At the rim of a dense patch all known neighbours belong
/// to the patch; a sparse point a third of its spacing away from the patch sees 16 of them within half its
/// spacing. Looking twice as far would cost much in a scan with many rims.
constexpr float kLook = 4.0f;
/// The least share that a cell at a rim must fill of the disc around it. A strip between two neighbours at a
/// rim then ends about a spacing outside.
constexpr float kFill = 0.4f;
constexpr float kShrink = 0.85f;
constexpr int kMostShrinks = 12;
/// From a spacing (neighbours in half a disc) to nearly the fixed point, which a straight rim has at .55
/// spacings.
constexpr int kRimSteps = 4;
/// A cell reaches over a rim in directions in which it is longer than this, in spacings of a rim. The mean of
/// these directions is at least kOneSide long if they are on one side.
constexpr float kOverRim = 2.0f, kOneSide = 0.4f;
constexpr float kCoincident = 1e-10f;

}  // namespace

TangentFrame tangent_frame(const glm::vec3& normal) {
    const glm::vec3 size = glm::abs(normal);
    const glm::vec3 axis = size.x <= size.y && size.x <= size.z ? glm::vec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::vec3(0, 1, 0)
                                                                : glm::vec3(0, 0, 1);
    const glm::vec3 x = glm::normalize(glm::cross(normal, axis));
    return {normal, x, glm::cross(normal, x)};
}

ShareCell::ShareCell(const glm::vec3& normal, float reach, size_t neighbours, float seen, bool apart)
    : frame_(tangent_frame(normal)),
      reach_(reach),
      known_(kKnown * std::min(seen, kMostSeen * reach)),
      widest_search_((apart ? 2 : 1) * kLook * reach),
      rim_spacing_(reach * std::sqrt(kPi / 2 / static_cast<float>(neighbours))),
      least_(2 / widest_search_) {
    nearness_.fill(least_);
}

void ShareCell::cut(const Patch& neighbours, const std::vector<float>& heights, const Range& layer,
                    bool others) {
    const size_t here =
        cut_by_layer(neighbours, heights, layer, frame_, kCoincident * reach_ * reach_, others, nearness_);
    coincident_ = std::max<size_t>(here, 1) - 1;  // without the point itself
    least_ = least_of(nearness_);
}

void ShareCell::cut_at(const glm::vec3& normal, float offset) {
    const float u = glm::dot(normal, frame_.x) / offset, v = glm::dot(normal, frame_.y) / offset;
    const Directions& to = directions();
    for (size_t d = 0; d < kDirections; ++d) nearness_[d] = std::max(nearness_[d], u * to.x[d] + v * to.y[d]);
    least_ = least_of(nearness_);
}

size_t ShareCell::cut_open(const Tile& around, const glm::vec3& centre, float radius) {
    const Slope slope{centre, radius * radius, kSlope2, kCoincident * reach_ * reach_};
    Nearness further = nearness_;
    const size_t nearest = cut_by_slope(around, slope, frame_, reach_ * reach_, further);
    const float known = 1 / known_;
    for (size_t d = 0; d < kDirections; ++d) nearness_[d] = nearness_[d] < known ? further[d] : nearness_[d];
    least_ = least_of(nearness_);
    return nearest;
}

float ShareCell::widest_cut() const {
    return 2 / least_;
}

bool ShareCell::open() const {
    return least_ * known_ < 1;
}

bool ShareCell::closed() const {
    return least_ > 2 / widest_search_;
}

std::optional<glm::vec3> ShareCell::outward() const {
    const Directions& to = directions();
    const float rim = 1 / (kOverRim * rim_spacing_);
    glm::vec2 sum(0.0f);
    int count = 0;
    for (size_t d = 0; d < kDirections; ++d)
        if (nearness_[d] < rim) sum += glm::vec2(to.x[d], to.y[d]), ++count;
    const float length = glm::length(sum);
    if (!(length > kOneSide * static_cast<float>(count))) return std::nullopt;
    return (frame_.x * sum.x + frame_.y * sum.y) / length;
}

float ShareCell::full_area() const {
    return kPi * mean_square_within(nearness_, std::numeric_limits<float>::infinity());
}

float ShareCell::area() const {
    return full_area() / static_cast<float>(1 + coincident_);
}

void ShareCell::cut_off(float radius) {
    for (float& n : nearness_) n = std::max(n, 1 / radius);
    least_ = std::max(least_, 1 / radius);
}

float ShareCell::area_at_rim() {
    if (!closed()) {
        float radius = rim_spacing_;
        for (int step = 1; step < kRimSteps && radius > 0; ++step)
            radius = std::sqrt(mean_square_within(nearness_, radius));
        if (radius > 0) cut_off(radius);
    }
    float filled = full_area();
    for (int step = 0; step < kMostShrinks; ++step) {
        const float farthest = 1 / least_;
        if (filled >= kFill * kPi * farthest * farthest) break;
        cut_off(kShrink * farthest);
        filled = full_area();
    }
    return filled / static_cast<float>(1 + coincident_);
}

}  // namespace lucarne::octree
