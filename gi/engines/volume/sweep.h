#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/volume/directions.h"
#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Carries light through the volume, one plane of voxels after the other along each of many directions (short
/// characteristics of the method of discrete ordinates; in graphics Fattal 2009, "Participating media
/// illumination using light propagation maps"). A voxel of air takes the radiance of the four voxels before
/// it, weighted bilinearly; an occupied one stops it at its faces and sends out their radiance.
class Sweeper {
 public:
    /// Returns the radiance that comes from outside along a direction (the way that light goes).
    using Outside = std::function<glm::vec3(const glm::vec3& way)>;

    explicit Sweeper(const Space& space);

    /// Begins with this radiance of the faces, W/(sr m^2), the same in all directions.
    void begin(Directions directions, std::span<const glm::vec3> radiance, Outside outside);
    /// Sweeps along the next few directions. Returns false when all are done.
    bool advance();
    /// Returns the irradiance of all faces, W/m^2, when advance() has returned false.
    std::vector<glm::vec3> irradiance() const;

 private:
    /// Each group adds up its own directions, so that the sums do not depend on the number of threads.
    static constexpr size_t kGroups = 8;
    using Vector = float __attribute__((vector_size(16)));
    /// Radiance: r, g, b, and how much of it is known.
    struct Four {
        Vector v{};
    };
    /// Occupied voxels by the planes across an axis.
    struct Order {
        std::vector<uint32_t> voxels, places;  ///< places: in a plane with a border of one cell
        std::vector<size_t> starts;            ///< by plane, and the end
    };
    void sweep(const glm::vec3& way, std::vector<Four>& target) const;

    const Space& space_;
    std::array<Order, 3> orders_;
    Directions directions_;
    std::vector<std::array<Four, kSides>> radiance_;  ///< by occupied voxel; w 1: the side has a face
    Outside outside_;
    std::array<std::vector<Four>, kGroups> sums_;  ///< by face
    size_t done_ = 0;                              ///< directions of each group
};

}  // namespace lucarne::gi::volume
