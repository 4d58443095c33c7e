#include "octree/growing/quick_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/normals.h"
#include "octree/normals/surface/plane.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr size_t kNeighbours = 10;
constexpr size_t kWindow = 12;  ///< points examined on each side along each curve
/// Offset between the curves, in cube sizes: no cell border is one of both.
constexpr double kShift = 0.3717;
/// Largest ratio of the variance across a plane to the mean of those along it.
constexpr float kFlatness = 0.15f;
/// Corrects the share, because some neighbours are missed and those found instead are farther. Without it, a
/// square and a sphere of random points measure 1.25 times their surface
/// (tests/octree/growing/growing_build_test.cpp checks the corrected sum to within a tenth).
constexpr double kMissed = 0.8;
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
    struct Found {
        float distance2;
        uint32_t index;
        glm::vec3 offset;
    };
    void add(uint32_t index, const glm::vec3& offset) {
        const float distance2 = glm::dot(offset, offset);
        if (count_ == kNeighbours && distance2 >= found_[count_ - 1].distance2) return;
        for (size_t i = 0; i < count_; ++i)
            if (found_[i].index == index) return;
        size_t at = count_ < kNeighbours ? count_++ : count_ - 1;
        for (; at > 0 && found_[at - 1].distance2 > distance2; --at) found_[at] = found_[at - 1];
        found_[at] = {distance2, index, offset};
    }
    std::span<const Found> found() const { return std::span(found_).first(count_); }

 private:
    std::array<Found, kNeighbours> found_;
    size_t count_ = 0;
};

void add(Moments& moments, const glm::vec3& p) {
    const float products[6] = {p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z};
    for (int axis = 0; axis < 3; ++axis) moments.sum[static_cast<size_t>(axis)] += p[axis];
    for (size_t i = 0; i < 6; ++i) moments.products[i] += products[i];
}

}  // namespace

std::vector<QuickSurface> quick_surface(std::span<const glm::dvec3> points, const Cube& root,
                                        std::span<const std::optional<glm::dvec3>> stations) {
    // In units of the root cube, floats can represent the squares of any cloud's distances.
    const double scale = 1 / root.size;
    const Cube shifted{root.min - glm::dvec3(kShift * root.size), root.size * (1 + 2 * kShift)};
    const std::array<Curve, 2> curves = {Curve(points, root), Curve(points, shifted)};
    std::vector<QuickSurface> surface(points.size());
    std::vector<float> neighbours_area(points.size());
    std::vector<std::array<uint32_t, kNeighbours>> near(points.size());
    parallel_ranges(points.size(), 1 << 13, [&](size_t first, size_t last) {
        for (size_t rank = first; rank < last; ++rank) {
            const uint32_t i = curves[0].order[rank].index;
            Nearest nearest;
            for (const Curve& curve : curves) {
                const size_t here = curve.rank[i], from = here - std::min(here, kWindow),
                             to = std::min(here + kWindow + 1, points.size());
                for (size_t at = from; at < to; ++at) {
                    const uint32_t other = curve.order[at].index;
                    if (other != i) nearest.add(other, glm::vec3((points[other] - points[i]) * scale));
                }
            }
            const auto found = nearest.found();
            near[i].fill(i);
            if (found.size() < 3) continue;
            Moments moments{found.size() + 1, {}, {}};  // the point itself adds nothing to the sums
            for (size_t n = 0; n < found.size(); ++n) {
                near[i][n] = found[n].index;
                add(moments, found[n].offset);
            }
            surface[i].area = static_cast<float>(kMissed * std::numbers::pi * found.back().distance2 /
                                                 static_cast<double>(found.size()));
            const Plane plane = plane_of(moments);
            if (plane.variances[0] > kFlatness * 0.5 * (plane.variances[1] + plane.variances[2])) continue;
            if (!stations[i]) continue;
            const double facing = glm::dot(plane.normal, *stations[i] - points[i]);
            surface[i].normal = glm::vec3(facing < 0 ? -plane.normal : plane.normal);
        }
    });
    parallel_ranges(points.size(), 1 << 14, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            std::array<float, kNeighbours> areas;
            for (size_t n = 0; n < kNeighbours; ++n) areas[n] = surface[near[i][n]].area;
            std::nth_element(areas.begin(), areas.begin() + kNeighbours / 2, areas.end());
            neighbours_area[i] = areas[kNeighbours / 2];
        }
    });
    for (size_t i = 0; i < points.size(); ++i)
        if (neighbours_area[i] > 0 && surface[i].area > kStray * neighbours_area[i])
            surface[i] = {glm::vec3(0.0f), kStrayArea};
    return surface;
}

}  // namespace lucarne::octree
