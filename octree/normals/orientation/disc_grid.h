#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/orientation/sight.h"

namespace lucarne::octree {

/// Discs in a grid of cells, for rays. Lengths are in cells. Discs far outside all others are left out.
class DiscGrid {
 public:
    explicit DiscGrid(std::span<const SightDisc> discs);

    const glm::vec3& at(uint32_t disc) const { return at_[disc]; }
    const glm::vec3& normal(uint32_t disc) const { return normal_[disc]; }
    float radius(uint32_t disc) const { return radius_[disc]; }

    static constexpr uint32_t kNone = UINT32_MAX;  ///< the ray hits nothing
    static constexpr uint32_t kLost = kNone - 1;   ///< the ray was given up among too many discs
    struct Hit {
        uint32_t disc = kNone;
        float distance = std::numeric_limits<float>::infinity();
        float facing = 0;  ///< the disc's normal times the ray's direction
    };
    /// Returns the first disc that a ray hits, other than `own`. `direction`: unit.
    Hit first(const glm::vec3& from, const glm::vec3& direction, uint32_t own) const;

 private:
    bool inside(const glm::ivec3& cell) const;
    size_t index(const glm::ivec3& cell) const {
        return (static_cast<size_t>(cell.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(cell.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(cell.x);
    }
    template <class Use>
    void each_cell(size_t disc, const Use& use) const;

    glm::ivec3 size_{0};
    std::vector<glm::vec3> at_, normal_;
    std::vector<float> radius_;
    std::vector<uint32_t> starts_, members_;  ///< discs by cell
};

}  // namespace lucarne::octree
