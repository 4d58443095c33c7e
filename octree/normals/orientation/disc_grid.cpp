#include "octree/normals/orientation/disc_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "octree/tree/footprint.h"

namespace lucarne::octree {
namespace {

constexpr double kCells = 3.2;       ///< along the longest axis, times the cubic root of the number of discs
constexpr float kMostRadius = 2;     ///< cells; larger discs would be in too many of them
constexpr double kOutside = 0.001;   ///< share of the discs that may lie beyond each face of the grid
constexpr size_t kMostTests = 4096;  ///< discs that a ray may meet in its cells

/// Returns the value below which a share of the values lies.
double quantile(std::vector<double>& values, double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<size_t>(at)];
}

}  // namespace

DiscGrid::DiscGrid(std::span<const SightDisc> discs) {
    std::vector<double> values(discs.size());
    glm::dvec3 low{0.0}, high{0.0};
    for (int axis = 0; axis < 3; ++axis) {
        for (size_t i = 0; i < discs.size(); ++i) values[i] = discs[i].position[axis];
        low[axis] = quantile(values, kOutside);
        high[axis] = quantile(values, 1 - kOutside);
    }
    for (size_t i = 0; i < discs.size(); ++i)
        values[i] = std::sqrt(kCoverageRaw * discs[i].area / std::numbers::pi);
    const glm::dvec3 extent = high - low;
    const int most = static_cast<int>(kCells * std::cbrt(static_cast<double>(discs.size()))) + 3;
    const double cell =
        std::max({quantile(values, 0.5), std::max({extent.x, extent.y, extent.z}) / (most - 2),
                  std::numeric_limits<double>::min()});
    const glm::dvec3 origin = low - cell;
    for (int axis = 0; axis < 3; ++axis)
        size_[axis] = std::min(most, static_cast<int>(extent[axis] / cell) + 3);

    at_.resize(discs.size());
    normal_.resize(discs.size());
    radius_.resize(discs.size());
    for (size_t i = 0; i < discs.size(); ++i) {
        at_[i] = glm::vec3((discs[i].position - origin) / cell);
        normal_[i] = discs[i].normal;
        radius_[i] =
            std::min(kMostRadius,
                     static_cast<float>(std::sqrt(kCoverageRaw * discs[i].area / std::numbers::pi) / cell));
    }
    starts_.assign(
        static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z) + 1, 0);
    for (size_t i = 0; i < discs.size(); ++i) each_cell(i, [&](size_t c) { ++starts_[c + 1]; });
    for (size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    members_.resize(starts_.back());
    for (size_t i = discs.size(); i-- > 0;)
        each_cell(i, [&](size_t c) { members_[--starts_[c + 1]] = static_cast<uint32_t>(i); });
    // Each start is now that of its own cell, one place too far.
    starts_.erase(starts_.begin());
    starts_.push_back(static_cast<uint32_t>(members_.size()));
}

bool DiscGrid::inside(const glm::ivec3& cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size_.x && cell.y < size_.y &&
           cell.z < size_.z;
}

template <class Use>
void DiscGrid::each_cell(size_t disc, const Use& use) const {
    const glm::vec3& n = normal_[disc];
    const glm::vec3 reach = radius_[disc] * glm::sqrt(glm::max(glm::vec3(0.0f), 1.0f - n * n));
    const glm::vec3 size(size_);
    if (glm::any(glm::lessThan(at_[disc], glm::vec3(0.0f))) ||
        glm::any(glm::greaterThanEqual(at_[disc], size)))
        return;
    const glm::ivec3 low(glm::max(glm::floor(at_[disc] - reach), 0.0f)),
        high(glm::min(glm::floor(at_[disc] + reach), size - 1.0f));
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) use(index({x, y, z}));
}

DiscGrid::Hit DiscGrid::first(const glm::vec3& from, const glm::vec3& direction, uint32_t own) const {
    Hit hit;
    // Cells that are far outside are no integers.
    glm::ivec3 cell(glm::floor(glm::clamp(from, glm::vec3(-1.0f), glm::vec3(size_)))), move;
    if (!inside(cell)) return hit;
    glm::vec3 next, step;  // distances to the next cell along each axis
    for (int axis = 0; axis < 3; ++axis) {
        const float along = std::max(std::abs(direction[axis]), 1e-12f),
                    in = from[axis] - static_cast<float>(cell[axis]);
        move[axis] = direction[axis] < 0 ? -1 : 1;
        step[axis] = 1 / along;
        next[axis] = (direction[axis] < 0 ? in : 1 - in) / along;
    }
    for (size_t tests = 0; inside(cell);) {
        const size_t at = index(cell);
        tests += starts_[at + 1] - starts_[at];
        // Far clusters of discs make cells so large that one may hold all the others.
        if (tests > kMostTests) return {kLost};
        for (uint32_t i = starts_[at]; i < starts_[at + 1]; ++i) {
            const uint32_t disc = members_[i];
            if (disc == own) continue;
            const float facing = glm::dot(normal_[disc], direction);
            const float distance = glm::dot(normal_[disc], at_[disc] - from) / facing;
            if (!(distance > 0 && distance < hit.distance)) continue;
            const glm::vec3 off = from + distance * direction - at_[disc];
            if (glm::dot(off, off) < radius_[disc] * radius_[disc]) hit = {disc, distance, facing};
        }
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        if (hit.distance <= next[axis]) break;
        cell[axis] += move[axis];
        next[axis] += step[axis];
    }
    return hit;
}

}  // namespace lucarne::octree
