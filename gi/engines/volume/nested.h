#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Returns a cell of air of the coarse space in the air that a fine cell of air lies in; none if the coarse
/// voxels about it are too coarse to show any. Either voxels are empty as a whole and touch, or a line of
/// sight through fine voxels connects them, so there is no wall between.
std::optional<glm::ivec3> coarse_air_at(const Space& coarse, const Space& fine, const glm::ivec3& cell);

/// Returns the irradiance of the coarse faces, interpolated at the fine ones; 0 where the coarse voxels show
/// no air before a face.
std::vector<glm::vec3> from_coarse(const Space& coarse, std::span<const glm::vec3> irradiance,
                                   const Space& fine);

/// What light that enters a fine space is read from: for each cell just outside of it, the coarse cells about
/// it. Only those are read that belong to the air of the fine cell before it.
class Border {
 public:
    static constexpr uint32_t kUnknown = 0xffffffffu;
    /// Eight cells of a box of coarse ones, of which those that are air count.
    struct Place {
        uint32_t first = kUnknown;  ///< the lowest one; kUnknown: nothing is known here
        glm::vec3 shares{0.0f};     ///< of the upper ones along each axis
    };

    Border(const Space& coarse, const Space& fine);

    /// The box of coarse cells.
    const glm::ivec3& low() const { return low_; }
    const glm::ivec3& size() const { return size_; }
    size_t cells() const {
        return static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z);
    }
    /// Returns the number of a cell in the box, x fastest.
    size_t number(const glm::ivec3& cell) const {
        const glm::ivec3 in = cell - low_;
        return (static_cast<size_t>(in.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(in.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(in.x);
    }
    /// Returns the place of a fine cell that lies just outside of this side, and perhaps of others.
    const Place& at(int side, const glm::ivec3& cell) const {
        return places_[static_cast<size_t>(side)][index(side, cell)];
    }

 private:
    size_t index(int side, const glm::ivec3& cell) const {
        const int u = (axis_of(side) + 1) % 3, v = (axis_of(side) + 2) % 3;
        return static_cast<size_t>(cell[v] + 1) * static_cast<size_t>(fine_size_[u] + 2) +
               static_cast<size_t>(cell[u] + 1);
    }
    Place place_of(const Space& coarse, const Space& fine, const glm::ivec3& cell) const;

    glm::ivec3 low_{0}, size_{0}, fine_size_{0};
    std::array<std::vector<Place>, kSides> places_;
};

}  // namespace lucarne::gi::volume
