#include "octree/normals/orientation/shell.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace lucarne::octree {
namespace {

constexpr float kLevelNormal = 0.9f;  ///< least |n.z| of floors: up to 25 degrees
/// Least |sum of area n.z| / sum of area |n.z| of a top that is not just the upper end of walls.
constexpr double kClearlyUp = 0.3;
/// Largest |sum of area n.z| / sum of area |n.z| of a closed surface; a sheet has 1.
constexpr double kClosed = 0.25;
/// Share of the extent's rectangle that floor and ceiling must each cover; L-shaped rooms have .5.
constexpr double kCovered = 0.4;

}  // namespace

void Shell::extend(const glm::dvec3& position) {
    bounds_.min = glm::min(bounds_.min, position);
    bounds_.max = glm::max(bounds_.max, position);
}

void Shell::Level::operator+=(const Level& other) {
    rise += other.rise;
    lie += other.lie;
    flat += other.flat;
}

Shell::Level& Shell::level_at(double z) {
    const double height = std::max(bounds_.max.z - bounds_.min.z, std::numeric_limits<double>::min());
    const double share = std::clamp((z - bounds_.min.z) / height, 0.0, 1.0);
    return levels_[std::min(kLevels - 1, static_cast<size_t>(share * kLevels))];
}

void Shell::add(const glm::dvec3& position, const glm::vec3& normal, float area) {
    const double lie = std::abs(normal.z);
    level_at(position.z) +=
        {static_cast<double>(area) * normal.z, area * lie, lie < kLevelNormal ? 0.0 : area};
}

void Shell::join(const Shell& part, bool opposite) {
    const Shell old = *this;
    bounds_.min = glm::min(bounds_.min, part.bounds_.min);
    bounds_.max = glm::max(bounds_.max, part.bounds_.max);
    levels_.fill({});
    for (const Shell* from : {&old, &part})
        for (size_t i = 0; i < kLevels; ++i) {
            Level level = from->levels_[i];
            if (!(level.lie > 0)) continue;
            if (from == &part && opposite) level.rise = -level.rise;
            const double middle = (static_cast<double>(i) + 0.5) / kLevels;
            level_at(glm::mix(from->bounds_.min.z, from->bounds_.max.z, middle)) += level;
        }
}

Shell::Level Shell::sum() const {
    Level whole;
    for (const Level& level : levels_) whole += level;
    return whole;
}

bool Shell::inside_out() const {
    const Level whole = sum();
    if (std::abs(whole.rise) > kClosed * whole.lie) return whole.rise < 0;
    const Level& top = levels_.back();
    const double up = std::abs(top.rise) > kClearlyUp * top.lie ? top.rise : whole.rise;
    const glm::dvec3 extent = bounds_.max - bounds_.min;
    const double covered = kCovered * extent.x * extent.y, floor = levels_.front().flat;
    const bool room = floor > covered && whole.lie - floor > covered;
    return (up < 0) != room;
}

}  // namespace lucarne::octree
