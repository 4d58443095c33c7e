#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace lucarne::viewer {

/// A grid over a box that says which cells contain points. World units.
class OccupancyGrid {
 public:
    /// Cells are as fine as the density of the points allows, at most kMostCells along the longest side, so
    /// that walls have no gaps, and at least `least_cell` large where eight such cells fit along that side.
    /// Points outside the box are ignored.
    OccupancyGrid(std::span<const glm::dvec3> points, const std::array<glm::dvec3, 2>& box,
                  double least_cell = 0);

    const glm::ivec3& size() const { return size_; }
    double cell() const { return cell_; }
    bool empty() const { return filled_ == 0; }
    bool occupied(const glm::ivec3& at) const { return inside(at) && cells_[index(at)] != 0; }
    /// Returns the middle of a cell.
    glm::dvec3 middle(const glm::ivec3& at) const { return low_ + (glm::dvec3(at) + .5) * cell_; }
    /// Returns the cell of a place, which may lie outside the grid.
    glm::ivec3 cell_of(const glm::dvec3& place) const {
        return glm::ivec3(glm::floor((place - low_) / cell_));
    }
    /// Returns the middles of all cells that contain points.
    std::vector<glm::dvec3> occupied_middles() const;

    /// What a ray meets first.
    struct Sight {
        double distance;  ///< to an occupied cell, or to where the ray leaves the box
        bool blocked;     ///< false: it leaves the box
    };
    /// Follows a ray (`along`: unit vector) from cell to cell (Amanatides & Woo 1987). The cell where it
    /// starts does not block it.
    Sight look(const glm::dvec3& from, const glm::dvec3& along) const;

 private:
    static constexpr int kMostCells = 128, kLeastCells = 8;

    bool inside(const glm::ivec3& at) const;
    size_t index(const glm::ivec3& at) const {
        return (static_cast<size_t>(at.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(at.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(at.x);
    }
    void fill(std::span<const glm::dvec3> points, double extent, int cells, const glm::dvec3& sides);

    glm::dvec3 low_{0.0};
    double cell_ = 1;
    glm::ivec3 size_{1};
    size_t filled_ = 0, counted_ = 0;  ///< occupied cells, and points in them
    std::vector<uint8_t> cells_;
};

}  // namespace lucarne::viewer
