#include "octree/normals/surface/crease.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "octree/normals/surface/surface_share.h"

namespace lucarne::octree {
namespace {

constexpr size_t kLeastRun = 6;  ///< points of a run
/// A side has at least one of so many points of the patch. That of a reveal that a station saw at a flat
/// angle, beside a dense wall, has hardly more. A plane across the two faces of a thin wall has fewer.
constexpr size_t kLeastPart = 5;
constexpr size_t kLeastSide = 8;  ///< points of each of two planes at a crease
/// Points within this many deviations of a plane belong to it. Where there is no noise, within this share of
/// the spacing.
constexpr float kInliers = 3.0f, kInSpacing = 0.05f;
constexpr float kLeastOffset = 0.1f;  ///< in spacings: a point's cell reaches at least so far to the crease
constexpr double kTurned = 0.91;      ///< largest |n.n'| of two planes at a crease: 24 degrees
constexpr int kRefits = 2;
/// The side of a crease is that much flatter (variance of heights) than the whole. Of noise, too, some part
/// is flatter than the whole, but only by half.
constexpr float kFlatter = 0.3f;
/// A run, or a first refit, that is not flatter than this is not the start of a side. Of the sides that are
/// used in the end, 99 of 100 begin with a flatter run.
constexpr float kFlatRun = 0.5f;
/// Least |n.n'| of a side and the whole window: 60 degrees. Between two sides at right angles it is 45
/// degrees where both have as many points, and more for the side that has fewer.
constexpr float kLeastTurn = 0.5f;

/// The variance of heights over a plane that was fitted to `count` points.
double variance_of(const Plane& plane, size_t count) {
    const double n = static_cast<double>(count);
    return plane.variances[0] * n / (n - 3);
}

float limit_of(const Plane& plane, size_t count, float spacing) {
    return std::max(kInliers * static_cast<float>(std::sqrt(variance_of(plane, count))),
                    kInSpacing * spacing);
}

glm::dvec3 middle_of(const Moments& m) {
    return glm::dvec3(m.sum[0], m.sum[1], m.sum[2]) / static_cast<double>(m.count);
}

bool is_better(const Side& side, const SurfaceFit& whole) {
    const float turn = std::abs(glm::dot(glm::vec3(side.plane.normal), whole.normal));
    return side.deviation < whole.deviation && side.variance < kFlatter * whole.variance && turn > kLeastTurn;
}

}  // namespace

std::optional<Side> fit_side(const Patch& patch, const SurfaceFit& whole, float spacing) {
    const SectorRun run = flattest_run(patch, tangent_frame(whole.normal), kLeastRun);
    if (run.moments.count == 0 || run.misfit > kFlatRun * whole.variance) return std::nullopt;
    Moments own = run.moments;
    Side side;
    side.plane = plane_of(own);
    side.count = own.count;
    Slab slab{};
    for (int refit = 0; refit < kRefits; ++refit) {
        slab = {glm::vec3(side.plane.normal), static_cast<float>(glm::dot(side.plane.normal, middle_of(own))),
                limit_of(side.plane, side.count, spacing)};
        own = moments_of_slab(patch, slab, false);
        if (own.count < std::max(kLeastSide, patch.count / kLeastPart) ||
            patch.count - own.count < kLeastSide)
            return std::nullopt;
        side.plane = plane_of(own);
        side.count = own.count;
        side.variance = static_cast<float>(variance_of(side.plane, side.count));
        if (side.variance > kFlatRun * whole.variance) return std::nullopt;
    }
    side.deviation = deviation_of(side.plane, side.count);
    if (!is_better(side, whole)) return std::nullopt;
    const Moments rest = moments_of_slab(patch, slab, true);
    const Plane other = plane_of(rest);
    if (std::abs(glm::dot(other.normal, side.plane.normal)) > kTurned) return std::nullopt;

    const float limit = limit_of(side.plane, side.count, spacing);
    const glm::dvec3 middle = middle_of(own);
    const auto level = static_cast<float>(glm::dot(side.plane.normal, middle));
    side.layer = {std::min(0.0f, level - limit), std::max(0.0f, level + limit)};
    side.other = glm::vec3(other.normal);
    const double offset = glm::dot(other.normal, middle_of(rest));
    // The side's points tell on which side of the other plane it lies; noise may put the point across.
    const bool below = glm::dot(other.normal, middle) < offset, across = below != (0 < offset);
    const float least = kLeastOffset * spacing;
    side.offset = static_cast<float>(offset);
    side.rises = glm::dot(side.plane.normal, middle_of(rest)) > level;
    side.roughness = static_cast<float>(std::sqrt(variance_of(other, rest.count)));
    if (std::abs(side.offset) < (across ? std::max(2 * limit, least) : least))
        side.offset = below ? least : -least;
    return side;
}

}  // namespace lucarne::octree
