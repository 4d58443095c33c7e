#include "octree/normals/surface_share.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Corners up to this share of the reach count as known. A corner is the centre of an empty disc: beyond the
/// reach only part of it is unseen, and in a Poisson pattern the chance of such a disc to be empty is e^-10.
constexpr float kKnown = 0.8f;
/// How much farther than the known neighbours the surface is looked for. At the rim of a dense patch these
/// are all of the patch; a sparse point a third of its spacing away from it sees 16 of them within half its
/// spacing. Twice as far would cost much in a scan with many rims.
constexpr float kLook = 4.0f;
/// What goes on with the surface: lower than this over the tangent plane, over the distance along it (14
/// degrees).
constexpr float kSlope = 0.25f;
/// The least share that a cell at a rim fills of the disc around it. A strip between two neighbours of a rim
/// then ends about a spacing outside.
constexpr float kFill = 0.4f;
constexpr float kShrink = 0.85f;
constexpr int kMostShrinks = 12;
constexpr int kRimSteps = 4;  ///< from a spacing (neighbours in half a disc) to nearly the fixed point, which
                              ///< a straight rim has at .55 spacings
constexpr float kCoincident = 1e-10f;
constexpr size_t kBlock = 64;  ///< neighbours projected at a time

/// The two coordinates in the tangent plane of some points, and twice these over their squared length: what
/// they cut by. Zero, which cuts nothing, where `wanted` says no.
struct Projected {
    std::array<float, kBlock> x, y;
    size_t count = 0;

    template <class Wanted>
    void take(const Patch& patch, size_t first, const glm::vec3& to_x, const glm::vec3& to_y,
              const Wanted& wanted) {
        count = std::min(kBlock, patch.count - first);
        for (size_t i = 0; i < count; ++i) {
            const float px = patch.x[first + i], py = patch.y[first + i], pz = patch.z[first + i];
            const float u = px * to_x.x + py * to_x.y + pz * to_x.z,
                        v = px * to_y.x + py * to_y.y + pz * to_y.z;
            const float length2 = u * u + v * v;
            const float scale = wanted(first + i, length2) ? 2.0f / length2 : 0.0f;
            x[i] = scale * u;
            y[i] = scale * v;
        }
    }
};

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
    nearness_.fill(2 / widest_search_);
}

void ShareCell::cut(const Patch& neighbours, const std::vector<float>& heights, const Range& layer) {
    const float coincident2 = kCoincident * reach_ * reach_;
    Projected cuts;
    size_t here = 0;  // the point itself, too
    for (size_t first = 0; first < neighbours.count; first += kBlock) {
        cuts.take(neighbours, first, x_, y_, [&](size_t i, float length2) {
            const bool in = (heights[i] >= layer.low) & (heights[i] <= layer.high);
            const bool apart = length2 > coincident2;
            here += in & !apart;
            return in & apart;
        });
        cut_by(cuts.x.data(), cuts.y.data(), cuts.count, nearness_);
    }
    coincident_ = std::max<size_t>(here, 1) - 1;
}

void ShareCell::cut_open(const Patch& around) {
    const float widest2 = widest_cut() * widest_cut(), coincident2 = kCoincident * reach_ * reach_;
    std::array<float, kDirections> further = nearness_;
    Projected cuts;
    for (size_t first = 0; first < around.count; first += kBlock) {
        cuts.take(around, first, x_, y_, [&](size_t i, float length2) {
            const float height = around.x[i] * normal_.x + around.y[i] * normal_.y + around.z[i] * normal_.z;
            return (length2 > coincident2) & (length2 < widest2) &
                   (height * height <= kSlope * kSlope * length2);
        });
        size_t used = 0;
        for (size_t i = 0; i < cuts.count; ++i) {
            cuts.x[used] = cuts.x[i];
            cuts.y[used] = cuts.y[i];
            used += (cuts.x[i] != 0) | (cuts.y[i] != 0);
        }
        cut_by(cuts.x.data(), cuts.y.data(), used, further);
    }
    const float known = 1 / (kKnown * reach_);
    for (size_t d = 0; d < kDirections; ++d)
        if (nearness_[d] < known) nearness_[d] = further[d];
}

bool ShareCell::goes_on(const Patch& around, size_t i) const {
    const float height = glm::dot(around.offset(i), normal_);
    return height * height <= kSlope * kSlope * (around.distance2[i] - height * height);
}

float ShareCell::least() const {
    return *std::min_element(nearness_.begin(), nearness_.end());
}

float ShareCell::widest_cut() const {
    return 2 / least();
}

bool ShareCell::open() const {
    return least() * kKnown * reach_ < 1;
}

bool ShareCell::closed() const {
    return least() > 2 / widest_search_;
}

float ShareCell::area() const {
    float sum = 0;
    for (const float n : nearness_) sum += 1 / (n * n);
    return kPi / kDirections * sum / static_cast<float>(1 + coincident_);
}

void ShareCell::cut_off(float radius) {
    for (float& n : nearness_) n = std::max(n, 1 / radius);
}

/// Of the distances of the cell's sides from the point, over their angles; what is farther left out.
float ShareCell::mean_square_within(float radius) const {
    float sum = 0, count = 0;
    for (const float n : nearness_) {
        if (n * radius <= 1) continue;
        sum += 1 / (n * n);
        ++count;
    }
    return count > 0 ? sum / count : 0.0f;
}

float ShareCell::area_at_rim() {
    if (!closed()) {
        float radius = rim_spacing_;
        for (int step = 1; step < kRimSteps && radius > 0; ++step)
            radius = std::sqrt(mean_square_within(radius));
        if (radius > 0) cut_off(radius);
    }
    for (int step = 0; step < kMostShrinks; ++step) {
        const float filled = area() * static_cast<float>(1 + coincident_), farthest = 1 / least();
        if (filled >= kFill * kPi * farthest * farthest) break;
        cut_off(kShrink * farthest);
    }
    return area();
}

}  // namespace lucarne::octree
