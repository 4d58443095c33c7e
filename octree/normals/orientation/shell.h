#pragma once

#include <array>
#include <limits>

#include <glm/vec3.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {

/// Summarizes a connected, consistently oriented surface, to tell which of its sides was seen where no
/// station tells it.
///
/// A sheet, or a surface that is open below (the vertical parts of its area-weighted normals do not cancel),
/// was seen from above: most of it must point up. A closed surface was seen from outside, so normals near its
/// top must point up. The exception is a room. It is recognized by a level floor under most of its extent and
/// as much surface above the floor, which nothing seen from outside shows. The top of a room is a ceiling,
/// whose normals must point down. A box sampled on all sides, bottom included, counts as a room.
class Shell {
 public:
    /// Call extend() for all points first, then add() for each, with its normal (as oriented now) and its
    /// share of the surface.
    void extend(const glm::dvec3& position);
    void add(const glm::dvec3& position, const glm::vec3& normal, float area);
    /// Adds a part of the same surface, whose normals are flipped if `opposite`.
    void join(const Shell& part, bool opposite);
    /// Whether all normals must be flipped to face the side that was seen.
    bool inside_out() const;
    /// The surface that tells: its area as seen from above.
    double evidence() const { return sum().lie; }

 private:
    /// Sums over the points in one tenth of the height.
    struct Level {
        double rise = 0;  ///< sum of area n.z
        double lie = 0;   ///< sum of area |n.z|
        double flat = 0;  ///< sum of the area of nearly horizontal points
        void operator+=(const Level& other);
    };
    static constexpr size_t kLevels = 10;
    Level& level_at(double z);
    Level sum() const;

    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Box bounds_{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    std::array<Level, kLevels> levels_{};  ///< from the bottom up
};

}  // namespace lucarne::octree
