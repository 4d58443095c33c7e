#include "viewer/opening/occupancy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

/// Mean number of points in an occupied cell from which few cells of a surface are empty by chance.
constexpr double kDense = 4;

}  // namespace

OccupancyGrid::OccupancyGrid(std::span<const glm::dvec3> points, const std::array<glm::dvec3, 2>& box,
                             double least_cell)
    : low_(box[0]) {
    const glm::dvec3 sides = glm::max(box[1] - box[0], glm::dvec3(0.0));
    const double extent = std::max({sides.x, sides.y, sides.z});
    if (!std::isfinite(extent) || extent <= 0 || !std::isfinite(glm::length(low_))) {
        cells_.assign(1, 0);
        return;
    }
    const double most = least_cell > 0 ? extent / least_cell : kMostCells;
    const int first = static_cast<int>(std::clamp<double>(most, kLeastCells, kMostCells));
    for (int cells = first; cells >= kLeastCells; cells = cells * 4 / 5) {
        fill(points, extent, cells, sides);
        if (static_cast<double>(counted_) >= kDense * static_cast<double>(filled_)) break;
    }
}

void OccupancyGrid::fill(std::span<const glm::dvec3> points, double extent, int cells,
                         const glm::dvec3& sides) {
    cell_ = extent / cells;
    size_ = glm::clamp(glm::ivec3(glm::ceil(sides / cell_)), glm::ivec3(1), glm::ivec3(cells));
    cells_.assign(static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z),
                  0);
    filled_ = counted_ = 0;
    for (const glm::dvec3& p : points) {
        const glm::dvec3 place = (p - low_) / cell_;
        const double tolerance = 1e-6;  // points on the box's upper faces belong to the last cells
        if (!(place.x >= 0 && place.y >= 0 && place.z >= 0 && place.x <= size_.x + tolerance &&
              place.y <= size_.y + tolerance && place.z <= size_.z + tolerance))
            continue;
        uint8_t& there = cells_[index(glm::min(glm::ivec3(place), size_ - 1))];
        filled_ += there == 0;
        there = 1;
        ++counted_;
    }
}

bool OccupancyGrid::inside(const glm::ivec3& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size_.x && at.y < size_.y && at.z < size_.z;
}

std::vector<glm::dvec3> OccupancyGrid::occupied_middles() const {
    std::vector<glm::dvec3> middles;
    middles.reserve(filled_);
    for (int z = 0; z < size_.z; ++z)
        for (int y = 0; y < size_.y; ++y)
            for (int x = 0; x < size_.x; ++x)
                if (cells_[index({x, y, z})]) middles.push_back(middle({x, y, z}));
    return middles;
}

OccupancyGrid::Sight OccupancyGrid::look(const glm::dvec3& from, const glm::dvec3& along) const {
    const glm::dvec3 place = (from - low_) / cell_;
    glm::ivec3 at = cell_of(from);
    if (!inside(at)) return {0, false};
    glm::ivec3 step(0);
    glm::dvec3 next(std::numeric_limits<double>::infinity()), between = next;
    for (int axis = 0; axis < 3; ++axis) {
        if (along[axis] == 0) continue;
        step[axis] = along[axis] > 0 ? 1 : -1;
        between[axis] = 1 / std::abs(along[axis]);
        const double border = at[axis] + (along[axis] > 0 ? 1 : 0);
        next[axis] = (border - place[axis]) / along[axis];
    }
    for (double distance = 0;;) {
        const int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
        distance = next[axis];
        if (!std::isfinite(distance)) return {0, false};  // no direction
        at[axis] += step[axis];
        next[axis] += between[axis];
        if (!inside(at)) return {distance * cell_, false};
        if (cells_[index(at)]) return {distance * cell_, true};
    }
}

}  // namespace lucarne::viewer
