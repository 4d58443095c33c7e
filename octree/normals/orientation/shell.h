#pragma once

#include <array>
#include <limits>

#include <glm/vec3.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {

/// What is kept of a connected, consistently oriented surface to tell which of its sides was seen when no
/// station does.
///
/// A sheet, or what is open below (the vertical parts of its area-weighted normals do not cancel), was seen
/// from above: most of it points up. What is closed was seen from outside, so that normals near its top point
/// up; unless it is a room, known by what nothing seen from outside shows: a level floor under most of its
/// extent and as much surface above it. Then the top is a ceiling, whose normals point down. A box sampled
/// all round, bottom included, counts as a room.
class Shell {
 public:
    /// All points first, then each with its normal (as turned now) and its share of the surface.
    void extend(const glm::dvec3& position);
    void add(const glm::dvec3& position, const glm::vec3& normal, float area);
    /// Joins what is part of the same whole, its normals turned where `opposite`.
    void join(const Shell& part, bool opposite);
    /// Whether all normals must be turned to face the side that was seen.
    bool inside_out() const;

 private:
    /// Sums over what lies within a tenth of the height.
    struct Level {
        double rise = 0;  ///< of area n.z
        double lie = 0;   ///< of area |n.z|
        double flat = 0;  ///< of area, of what is nearly horizontal
        void operator+=(const Level& other);
    };
    static constexpr size_t kLevels = 10;
    Level& level_at(double z);
    Level sum() const;

    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Box bounds_{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    std::array<Level, kLevels> levels_{};  ///< from the bottom
};

}  // namespace lucarne::octree
