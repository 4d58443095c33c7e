#include "octree/normals/surface_share.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Corners up to this share of the reach count as known. A corner is the centre of an empty disc: beyond the
/// reach only part of it is unseen, and in a Poisson pattern the chance of such a disc to be empty is e^-10.
constexpr float kKnown = 0.8f;
/// How much farther than the known neighbours the surface is looked for. At the rim of a dense patch these
/// are all of the patch; a sparse point a third of its spacing away from it sees 16 of them within half its
/// spacing. Twice as far would cost a second per million points of a scan with many rims.
constexpr float kLook = 4.0f;
/// What goes on with the surface: lower than this over the tangent plane, over the distance along it (14
/// degrees).
constexpr float kSlope = 0.25f;
/// The least share that a cell at a rim fills of the disc around it. A strip between two neighbours of a rim
/// then ends about a spacing outside.
constexpr float kFill = 0.35f;
constexpr float kShrink = 0.85f;
constexpr int kMostShrinks = 12;
constexpr int kRimSteps = 4;  ///< from a spacing (neighbours in half a disc) to nearly the fixed point, which
                              ///< a straight rim has at .55 spacings
constexpr float kCuts = 1.001f;  ///< more than rounding
constexpr float kCoincident = 1e-10f;

const std::array<glm::vec2, 8>& octagon() {
    constexpr float h = std::numbers::sqrt2_v<float> / 2;
    static const std::array<glm::vec2, 8> directions{
        {{1, 0}, {h, h}, {0, 1}, {-h, h}, {-1, 0}, {-h, -h}, {0, -1}, {h, -h}}};
    return directions;
}

float cross(const glm::vec2& a, const glm::vec2& b) {
    return a.x * b.y - a.y * b.x;
}

}  // namespace

ShareCell::ShareCell(const glm::vec3& normal, float reach, size_t neighbours)
    : normal_(normal),
      reach_(reach),
      widest_search_(kLook * reach),
      rim_spacing_(reach * std::sqrt(kPi / 2 / static_cast<float>(neighbours))) {
    const glm::vec3 size = glm::abs(normal);
    const glm::vec3 axis = size.x <= size.y && size.x <= size.z ? glm::vec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::vec3(0, 1, 0)
                                                                : glm::vec3(0, 0, 1);
    x_ = glm::normalize(glm::cross(normal, axis));
    y_ = glm::cross(normal, x_);
    const float half = widest_search_ / 2, side = half * (std::numbers::sqrt2_v<float> - 1);
    for (const glm::vec2& at :
         {glm::vec2(half, -side), glm::vec2(half, side), glm::vec2(side, half), glm::vec2(-side, half),
          glm::vec2(-half, side), glm::vec2(-half, -side), glm::vec2(-side, -half), glm::vec2(side, -half)})
        corners_[count_++] = {at, true};
    measure();
}

void ShareCell::cut(const glm::vec3& offset) {
    const glm::vec2 q(glm::dot(offset, x_), glm::dot(offset, y_));
    const float length2 = glm::dot(q, q);
    if (length2 <= kCoincident * reach_ * reach_)
        ++coincident_;
    else if (length2 < 4 * farthest_ * farthest_)
        cut(q, length2 / 2, false);
}

/// Keeps what has dot(direction, p) <= distance (Sutherland, Hodgman 1974).
void ShareCell::cut(const glm::vec2& direction, float distance, bool bound) {
    std::array<float, kMostCorners> over;
    bool any = false;
    for (size_t i = 0; i < count_; ++i) {
        over[i] = glm::dot(direction, corners_[i].at) - distance;
        any |= over[i] > 0;
    }
    if (!any) return;
    std::array<Corner, kMostCorners> kept;
    size_t count = 0;
    for (size_t i = 0; i < count_; ++i) {
        const size_t next = i + 1 < count_ ? i + 1 : 0;
        const bool in = over[i] <= 0, next_in = over[next] <= 0;
        if (count + 2 > kMostCorners) return;  // of so many corners another cut would not change much
        if (in) kept[count++] = corners_[i];
        if (in == next_in) continue;
        const float t = over[i] / (over[i] - over[next]);
        const glm::vec2 at = corners_[i].at + t * (corners_[next].at - corners_[i].at);
        kept[count++] = {at, in ? bound : corners_[i].bound};
    }
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count;
    measure();
}

void ShareCell::cut_off(float radius) {
    for (const auto& direction : octagon()) cut(direction, radius, true);
}

void ShareCell::measure() {
    float farthest2 = 0;
    for (size_t i = 0; i < count_; ++i)
        farthest2 = std::max(farthest2, glm::dot(corners_[i].at, corners_[i].at));
    farthest_ = std::sqrt(farthest2);
}

bool ShareCell::open() const {
    return farthest_ > kKnown * reach_;
}

bool ShareCell::wants(const glm::vec3& offset) const {
    const glm::vec2 q(glm::dot(offset, x_), glm::dot(offset, y_));
    const float length2 = glm::dot(q, q), height = glm::dot(offset, normal_), known = kKnown * reach_;
    if (height * height > kSlope * kSlope * length2) return false;
    for (size_t i = 0; i < count_; ++i) {
        const glm::vec2& p = corners_[i].at;
        if (2 * glm::dot(p, q) > kCuts * length2 && glm::dot(p, p) > known * known) return true;
    }
    return false;
}

float ShareCell::area() const {
    float twice = 0;
    for (size_t i = 0; i < count_; ++i)
        twice += cross(corners_[i].at, corners_[i + 1 < count_ ? i + 1 : 0].at);
    return twice / 2 / static_cast<float>(1 + coincident_);
}

bool ShareCell::closed() const {
    return std::none_of(corners_.begin(), corners_.begin() + count_, [](const Corner& c) { return c.bound; });
}

/// Of the distance of the cell's sides from the point, over their angles; the octagon's left out.
float ShareCell::mean_square_of_sides() const {
    float twice_area = 0, angles = 0;
    for (size_t i = 0; i < count_; ++i) {
        if (corners_[i].bound) continue;
        const glm::vec2 &a = corners_[i].at, &b = corners_[i + 1 < count_ ? i + 1 : 0].at;
        twice_area += cross(a, b);
        angles += std::atan2(cross(a, b), glm::dot(a, b));
    }
    return angles > 0 ? twice_area / angles : 0.0f;
}

float ShareCell::area_at_rim() {
    if (!closed())
        for (int step = 0; step < kRimSteps; ++step) {
            const float radius = step == 0 ? rim_spacing_ : std::sqrt(mean_square_of_sides());
            if (radius > 0) cut_off(radius);
        }
    for (int step = 0; step < kMostShrinks; ++step) {
        const float filled = area() * static_cast<float>(1 + coincident_);
        if (filled >= kFill * kPi * farthest_ * farthest_) break;
        cut_off(kShrink * farthest_);
    }
    return area();
}

}  // namespace lucarne::octree
