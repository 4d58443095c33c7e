#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi::volume {

/// Where the levels are that follow the camera. Level 0 holds the whole scene; each further one is half as
/// wide.
struct Focus {
    uint32_t levels = 1;
    // Without finer levels, the rest is zero.
    float side = 0;  ///< longest one of the scene, m
    glm::vec3 eye{0.0f}, forward{0.0f};

    /// What is seen lies before the camera, and so do the middles of the levels, by this share of their
    /// sides.
    static constexpr float kAhead = 0.3f;
    /// The levels stay where they are until the middle of the finest one has moved by so much of its side.
    static constexpr float kSlack = 0.1f;

    float side_of(size_t level) const { return std::ldexp(side, -static_cast<int>(level)); }
    glm::vec3 centre(size_t level) const { return eye + kAhead * side_of(level) * forward; }
    /// Returns whether levels that are placed by this need not move for a camera of which `now` is the focus.
    bool holds(const Focus& now) const {
        if (levels != now.levels || side != now.side) return false;
        const glm::vec3 away = glm::abs(now.centre(levels - 1) - centre(levels - 1));
        return levels == 1 || std::max({away.x, away.y, away.z}) <= kSlack * side_of(levels - 1);
    }
    bool operator==(const Focus&) const = default;
};

}  // namespace lucarne::gi::volume
