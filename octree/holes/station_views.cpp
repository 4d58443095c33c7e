#include "octree/holes/station_views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "octree/stations/cube_map.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kMostSide = 128, kLeastSide = 32;  // .7 and 2.8 degrees a cell
constexpr double kPointsOfCell = 2;                   ///< at least
constexpr float kReach = 0.8f;                        ///< radius that a point covers in the map, in spacings
constexpr float kMostReach = 4;                       ///< cells of the map
constexpr size_t kLeastPoints = 64;
/// Share of a station's points below its lowest direction: mixed pixels, the tripod.
constexpr float kBeyond = 0.001f;
/// The lowest direction varies by as much (sine) around the station, most if its place was estimated.
constexpr float kLowestVaries = 0.04f;
/// Where the lowest direction (its sine) is higher than this, it has nothing to do with a tripod.
constexpr float kDown = -0.5f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

StationViews::StationViews(const HoleSample& sample, uint64_t memory) {
    if (sample.stations.empty()) return;
    std::vector<std::vector<float>> heights(sample.stations.size());
    for (const HolePoint& point : sample.points) {
        if (point.station < 0) continue;
        const auto station = static_cast<size_t>(point.station);
        const glm::vec3 offset = point.position - sample.stations[station];
        heights[station].push_back(offset.z / std::max(glm::length(offset), 1e-6f));
    }
    const auto used = static_cast<uint64_t>(
        std::ranges::count_if(heights, [](const auto& of) { return of.size() >= kLeastPoints; }));
    const uint64_t per_station = sample.points.size() / std::max<uint64_t>(used, 1);
    side_ = static_cast<uint32_t>(std::sqrt(static_cast<double>(per_station) / (6 * kPointsOfCell)));
    side_ = std::clamp(side_, kLeastSide, kMostSide);
    while (side_ > kLeastSide && used * 6 * side_ * side_ * sizeof(float) > memory)
        side_ = std::max(kLeastSide, side_ / 2);
    if (used == 0 || used * 6 * side_ * side_ * sizeof(float) > memory) return;
    std::vector<uint32_t> view_of(heights.size(), UINT32_MAX);
    for (size_t i = 0; i < heights.size(); ++i) {
        if (heights[i].size() < kLeastPoints) continue;
        view_of[i] = static_cast<uint32_t>(views_.size());
        View& view = views_.emplace_back();
        view.position = sample.stations[i];
        view.range.assign(size_t{6} * side_ * side_, kInfinity);
        find_lowest(view, heights[i]);
    }
    for (const HolePoint& point : sample.points) {
        if (point.station < 0 || view_of[static_cast<size_t>(point.station)] == UINT32_MAX ||
            point.normal == glm::vec3(0.0f))
            continue;
        View& view = views_[view_of[static_cast<size_t>(point.station)]];
        splat(view, point, kReach * std::sqrt(point.area));
    }
    for (View& view : views_) close_gaps(view);
}

/// Finds the lowest directions in which the station received points; a tripod hides those below.
void StationViews::find_lowest(View& view, std::vector<float>& heights) {
    const auto beyond = static_cast<size_t>(kBeyond * static_cast<float>(heights.size()));
    const auto low = heights.begin() + static_cast<ptrdiff_t>(beyond);
    std::nth_element(heights.begin(), low, heights.end());
    view.below = *low < kDown ? *low + kLowestVaries : *low;
}

/// Enters the nearest range around in cells that received nothing, if most cells around did: the pattern of
/// the points has gaps there, and the scene has none.
void StationViews::close_gaps(View& view) const {
    constexpr int kMost = 5;  // of 8
    const std::vector<float> before = view.range;
    for (size_t face = 0; face < 6; ++face)
        for (size_t y = 1; y + 1 < side_; ++y)
            for (size_t x = 1; x + 1 < side_; ++x) {
                const size_t at = (face * side_ + y) * side_ + x;
                if (before[at] < kInfinity) continue;
                int received = 0;
                float nearest = kInfinity;
                for (size_t i = 0; i < 9; ++i) {
                    const float range = before[(face * side_ + y + i / 3 - 1) * side_ + x + i % 3 - 1];
                    received += range < kInfinity;
                    nearest = std::min(nearest, range);
                }
                if (received >= kMost) view.range[at] = nearest;
            }
}

/// Enters a point, as a disc of `radius` (m) in its surface.
void StationViews::splat(View& view, const HolePoint& point, float radius) const {
    const glm::vec3 offset = point.position - view.position;
    const float range = glm::length(offset);
    if (!(range > 0)) return;
    const float cell = 2.0f / static_cast<float>(side_) * range;  // m, at most
    const auto enter = [&](const glm::vec3& to) {
        float& known = view.range[cube_map_cell(to, side_)];
        known = std::min(known, glm::length(to));
    };
    const float reach = std::min(radius, kMostReach * cell);
    if (reach < 0.25f * cell) return enter(offset);
    const glm::vec3 axis = std::abs(point.normal.z) < 0.7f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    const glm::vec3 x = glm::normalize(glm::cross(point.normal, axis)), y = glm::cross(point.normal, x);
    const int steps = static_cast<int>(std::ceil(1.4f * reach / cell));
    for (int i = -steps; i <= steps; ++i)
        for (int j = -steps; j <= steps; ++j) {
            const float a = reach * static_cast<float>(i) / static_cast<float>(steps),
                        b = reach * static_cast<float>(j) / static_cast<float>(steps);
            if (a * a + b * b <= reach * reach) enter(offset + a * x + b * y);
        }
}

Sight StationViews::at(const glm::vec3& place, const glm::vec3& normal, float behind) const {
    constexpr float kRangeError = 0.01f, kLeastFacing = 0.02f;
    Sight best = Sight::hidden;
    for (const View& view : views_) {
        const glm::vec3 offset = place - view.position;
        const float range = glm::length(offset);
        if (!(range > 0) || offset.z < view.below * range) continue;
        const float seen = view.range[cube_map_cell(offset, side_)];
        if (seen > range * (1 + kRangeError) + behind) return Sight::through;
        // The range of the surface varies so much over a cell of the map.
        const float facing = std::max(std::abs(glm::dot(offset, normal)) / range, kLeastFacing);
        const float varies = 2 / static_cast<float>(side_) * range / facing;
        if (seen > range * (1 - kRangeError) - behind - varies) best = Sight::surface;
    }
    return best;
}

}  // namespace lucarne::octree
