#include "octree/growing/quick_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/normals.h"
#include "octree/normals/surface/plane.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr size_t kMostNeighbours = 10;
/// Offset between the curves, in cube sizes: no cell border is one of both.
constexpr double kShift = 0.3717;
/// Largest ratio of the variance across a plane to the mean of those along it.
constexpr float kFlatness = 0.15f;

/// How neighbours are searched for.
struct Search {
    size_t neighbours;
    size_t window;  ///< points examined on each side along each curve
    /// Corrects the share, because some neighbours are missed and those found instead are farther: without
    /// it, random points measure up to 1.5 times their surface (tests/octree/growing/quick_surface_test.cpp
    /// checks the corrected sums to within a tenth).
    double missed;
};
constexpr Search kForNormals{kMostNeighbours, 12, 0.8};
constexpr Search kForManyNormals{7, 5, 0.67};  ///< takes .7 times as long for 4 million points
constexpr Search kForShares{4, 4, 0.77};       ///< takes .4 times as long
constexpr size_t kMany = 1'000'000;

/// A point whose share is this many times that of its neighbours is an outlier, as in octree/normals.
constexpr float kStray = 49;

/// Points in the order of a curve.
struct Curve {
    std::vector<CodeIndex> order;
    std::vector<uint32_t> rank;

    Curve(std::span<const glm::dvec3> points, const Cube& cube) : order(points.size()), rank(points.size()) {
        parallel_ranges(points.size(), 1 << 14, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i)
                order[i] = {cube.place(points[i]).code(), static_cast<uint32_t>(i)};
        });
        sort_by_code(order, 3 * kMaxLevel);
        for (uint32_t i = 0; i < order.size(); ++i) rank[order[i].index] = i;
    }
};

/// Keeps the nearest of the added points, each once.
class Nearest {
 public:
    explicit Nearest(size_t most) : most_(most) {}
    struct Found {
        float distance2;
        uint32_t index;
        glm::vec3 offset;
    };
    void add(uint32_t index, const glm::vec3& offset) {
        const float distance2 = glm::dot(offset, offset);
        if (count_ == most_ && distance2 >= found_[count_ - 1].distance2) return;
        for (size_t i = 0; i < count_; ++i)
            if (found_[i].index == index) return;
        size_t at = count_ < most_ ? count_++ : count_ - 1;
        for (; at > 0 && found_[at - 1].distance2 > distance2; --at) found_[at] = found_[at - 1];
        found_[at] = {distance2, index, offset};
    }
    std::span<const Found> found() const { return std::span(found_).first(count_); }

 private:
    std::array<Found, kMostNeighbours> found_;
    size_t most_, count_ = 0;
};

void add(Moments& moments, const glm::vec3& p) {
    const float products[6] = {p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z};
    for (int axis = 0; axis < 3; ++axis) moments.sum[static_cast<size_t>(axis)] += p[axis];
    for (size_t i = 0; i < 6; ++i) moments.products[i] += products[i];
}

}  // namespace

std::vector<QuickSurface> quick_surface(std::span<const glm::dvec3> points, const Cube& root,
                                        std::span<const std::optional<glm::dvec3>> stations) {
    const bool any = std::ranges::any_of(stations, [](const auto& station) { return station.has_value(); });
    const Search search = !any ? kForShares : points.size() > kMany ? kForManyNormals : kForNormals;
    // In units of the root cube, floats can represent the squares of any cloud's distances.
    const double scale = 1 / root.size;
    const Cube shifted{root.min - glm::dvec3(kShift * root.size), root.size * (1 + 2 * kShift)};
    std::array<std::optional<Curve>, 2> made;
    parallel_ranges(2, 1, [&](size_t i, size_t) { made[i].emplace(points, i == 0 ? root : shifted); });
    const std::array<const Curve*, 2> curves = {&*made[0], &*made[1]};
    std::vector<QuickSurface> surface(points.size());
    std::vector<float> neighbours_area(points.size());
    std::vector<uint32_t> near(points.size() * search.neighbours);  // `neighbours` for each point
    parallel_ranges(points.size(), 1 << 13, [&](size_t first, size_t last) {
        for (size_t rank = first; rank < last; ++rank) {
            const uint32_t i = curves[0]->order[rank].index;
            Nearest nearest(search.neighbours);
            for (const Curve* curve : curves) {
                const size_t here = curve->rank[i], from = here - std::min(here, search.window),
                             to = std::min(here + search.window + 1, points.size());
                for (size_t at = from; at < to; ++at) {
                    const uint32_t other = curve->order[at].index;
                    if (other != i) nearest.add(other, glm::vec3((points[other] - points[i]) * scale));
                }
            }
            const auto found = nearest.found();
            const auto mine = std::span(near).subspan(i * search.neighbours, search.neighbours);
            std::ranges::fill(mine, i);
            if (found.size() < 3) continue;
            for (size_t n = 0; n < found.size(); ++n) mine[n] = found[n].index;
            surface[i].area = static_cast<float>(search.missed * std::numbers::pi * found.back().distance2 /
                                                 static_cast<double>(found.size()));
            if (!stations[i]) continue;
            Moments moments{found.size() + 1, {}, {}};  // the point itself adds nothing to the sums
            for (const auto& neighbour : found) add(moments, neighbour.offset);
            const Plane plane = plane_of(moments);
            if (plane.variances[0] > kFlatness * 0.5 * (plane.variances[1] + plane.variances[2])) continue;
            const double facing = glm::dot(plane.normal, *stations[i] - points[i]);
            surface[i].normal = glm::vec3(facing < 0 ? -plane.normal : plane.normal);
        }
    });
    parallel_ranges(points.size(), 1 << 14, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            std::array<float, kMostNeighbours> areas{};
            for (size_t n = 0; n < search.neighbours; ++n)
                areas[n] = surface[near[i * search.neighbours + n]].area;
            const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(search.neighbours / 2);
            std::nth_element(areas.begin(), middle,
                             areas.begin() + static_cast<std::ptrdiff_t>(search.neighbours));
            neighbours_area[i] = *middle;
        }
    });
    for (size_t i = 0; i < points.size(); ++i)
        if (neighbours_area[i] > 0 && surface[i].area > kStray * neighbours_area[i])
            surface[i] = {glm::vec3(0.0f), kStrayArea};
    return surface;
}

}  // namespace lucarne::octree
