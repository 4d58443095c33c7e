#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/engines/paths/point_grid.h"
#include "gi/engines/paths/sides.h"
#include "gi/engines/paths/surfaces.h"
#include "gi/engines/paths/walls.h"

namespace lucarne::gi::paths {

/// Gathering points serve pixels somewhat beyond their reach, so that several always do; pixels that none
/// serves take the nearest one within kFarReach times its reach.
inline constexpr float kPixelReach = 1.6f, kFarReach = 8;

/// A place at which light is gathered, for what lies within its reach.
struct GatheringPoint {
    glm::vec3 position{0.0f}, normal{0.0f, 0.0f, 1.0f};
    float reach = 0;   ///< m: how far its light is valid along the surface
    float radius = 0;  ///< of its surfel, m
    Side side = kNone;
    Walls walls;  ///< up to the distance at which pixels use its light
    bool operator==(const GatheringPoint&) const = default;
    /// Whether its numbers make sense, as those of a file may not.
    bool is_finite() const {
        return radius > 0 && std::isfinite(reach + radius + glm::dot(position, position)) &&
               std::isfinite(glm::dot(normal, normal)) && walls.are_finite();
    }
    /// Whether walls hide a place from it.
    bool is_hidden(const glm::vec3& place) const { return walls.hide(place - position, normal); }
};

/// Returns the error of using a point's light at another place (Yue et al. 2007, eq. 7, after Tabellion &
/// Lamorlette 2004): the larger one of the distance over the reach and of the turn of the normal over
/// `turn`, which is the root of 1 - cos of the largest angle. Distances across the surface count
/// kAcross times, which the paper does not do: steps of stairs are no neighbours.
inline constexpr float kAcross = 4;
inline float squared_error_of(const GatheringPoint& point, float reach, float turn, const glm::vec3& position,
                              const glm::vec3& normal) {
    const glm::vec3 offset = position - point.position;
    const float across = glm::dot(offset, point.normal);
    const float distance2 = glm::dot(offset, offset) + (kAcross * kAcross - 1) * across * across;
    const float turned2 = 1 - glm::dot(normal, point.normal);
    return std::max(distance2 / (reach * reach), turned2 / (turn * turn));
}
inline float error_of(const GatheringPoint& point, float reach, float turn, const glm::vec3& position,
                      const glm::vec3& normal) {
    return std::sqrt(std::max(squared_error_of(point, reach, turn, position, normal), 0.0f));
}

/// Distances between gathering points, m: R- and R+ of eq. 7.
struct Spacing {
    float least = 0, most = 0;
    bool operator==(const Spacing&) const = default;
};

/// Chooses gathering points and traces their rays. Candidates are the sides of all surfels in an order that
/// looks random; one becomes a point if the light of those before it cannot be used there (error_of() >= 1),
/// and if it does not lie in a gap or under the rim of a disc that sticks out. The result depends neither on
/// threads nor on where the work is interrupted.
class PointChooser {
 public:
    /// `surfaces` must outlive it; `rays` a point.
    PointChooser(const Surfaces& surfaces, const Spacing& spacing, uint32_t rays, uint64_t seed);

    /// What has been done.
    struct State {
        Spacing spacing;    ///< larger than asked for if the points would have been too many
        uint64_t next = 0;  ///< candidate
        std::vector<GatheringPoint> points;
        std::vector<RayHit> hits;  ///< of the rays of each point
        uint64_t parts = 0;        ///< Surfaces::parts_key(): hits name sides
    };
    const State& state() const { return state_; }
    /// Continues from a state of equal arguments. Returns false if it cannot be one.
    bool restore(State state);
    /// Examines some candidates. Returns whether any are left.
    bool advance();
    double share() const;

 private:
    uint64_t cell_key(const glm::vec3& position, uint32_t facing) const;
    void find_normals();
    bool is_covered(const glm::vec3& position, const glm::vec3& normal) const;
    bool is_narrow(Side side, const glm::vec3& normal) const;
    void start_over();

    const Surfaces& surfaces_;
    uint32_t rays_;
    uint64_t seed_;
    std::vector<Side> order_;
    std::vector<glm::vec3> normals_;  ///< means about the fronts of surfels
    double tests_a_pass_ = 1;         ///< candidates in the last step for each that passed its test
    PointGrid grid_;
    State state_;
};

}  // namespace lucarne::gi::paths
