#include "octree/normals/orientation/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "io/core/random.h"
#include "octree/normals/orientation/disc_grid.h"

namespace lucarne::octree {
namespace {

constexpr size_t kMostRays = 65536;
constexpr size_t kPointsOfARay = 8;  ///< at least
constexpr float kWidest = 0.9f;      ///< sine of the largest angle between a ray and the normal: 64 degrees
constexpr float kStart = 0.3f;       ///< radii in front of the disc at which a ray starts
constexpr float kTooNear = 1.5f;     ///< radii of both discs within which a hit may be of the same surface
constexpr float kGrazed = 0.2f;  ///< cosine below which a ray does not tell which side of a disc it comes to
/// Number of points for which a ray's vote weighs as much as an edge of the neighbourhood graph. Edges
/// between pieces grow with the root of the number of points.
constexpr double kPointsOfAVote = 9;

struct SightVote {
    uint32_t a = 0, b = 0;
    float same = 0;  ///< > 0: the same orientation; 0: no vote
};
using TwoSides = std::array<SightVote, 2>;

/// Returns a direction about `axis`, more rays near it, drawn by the number of the ray.
glm::vec3 direction_about(const glm::vec3& axis, uint64_t ray) {
    const glm::vec3 any = std::abs(axis.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 across = glm::normalize(glm::cross(axis, any)), other = glm::cross(axis, across);
    const float sine = kWidest * static_cast<float>(std::sqrt(unit_double(mix64(ray, 0))));
    const double turn = 2 * std::numbers::pi * unit_double(mix64(ray, 1));
    return std::sqrt(1 - sine * sine) * axis +
           sine * (static_cast<float>(std::cos(turn)) * across + static_cast<float>(std::sin(turn)) * other);
}

/// Casts a ray to each side of a disc. A scanner needs room, so of two sides that both see something the one
/// with more air before it counts more.
TwoSides look_around(const DiscGrid& grid, std::span<const SightDisc> discs, uint32_t own) {
    TwoSides votes;
    std::array<float, 2> away{};
    for (size_t side = 0; side < 2; ++side) {
        const glm::vec3 axis = side == 0 ? grid.normal(own) : -grid.normal(own);
        const glm::vec3 from = grid.at(own) + kStart * grid.radius(own) * axis;
        const auto hit = grid.first(from, direction_about(axis, 2 * uint64_t{own} + side), own);
        away[side] = hit.distance;
        if (hit.disc >= DiscGrid::kLost || discs[hit.disc].component == discs[own].component) continue;
        if (hit.distance < kTooNear * (grid.radius(own) + grid.radius(hit.disc)) ||
            std::abs(hit.facing) < kGrazed)
            continue;
        const bool same = (side == 0) == (hit.facing < 0);
        votes[side] = {discs[own].component, discs[hit.disc].component, same ? 1.0f : -1.0f};
    }
    if (std::isfinite(away[0]) && std::isfinite(away[1]))
        for (size_t side = 0; side < 2; ++side) votes[side].same *= 2 * away[side] / (away[0] + away[1]);
    return votes;
}

}  // namespace

void vote_by_sight(std::span<const SightDisc> discs, size_t points_each, SignVotes& votes) {
    if (discs.empty()) return;
    const DiscGrid grid(discs);
    const size_t stride = std::max((2 * discs.size() + kMostRays - 1) / kMostRays,
                                   (2 * kPointsOfARay + points_each - 1) / points_each);
    std::vector<TwoSides> found(discs.size() / stride);
    parallel_ranges(found.size(), 256, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            found[i] = look_around(grid, discs, static_cast<uint32_t>(i * stride));
    });
    const double weight = std::sqrt(static_cast<double>(points_each * stride) / kPointsOfAVote);
    for (const TwoSides& sides : found)
        for (const SightVote& vote : sides)
            if (vote.same != 0) votes.add(vote.a, vote.b, weight * vote.same);
}

}  // namespace lucarne::octree
