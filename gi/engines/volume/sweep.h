#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/volume/directions.h"
#include "gi/engines/volume/nested.h"
#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Carries light through the volume, one plane of voxels after the other along each of many directions (short
/// characteristics of the method of discrete ordinates; in graphics Fattal 2009, "Participating media
/// illumination using light propagation maps"). A voxel of air takes the radiance of the four voxels before
/// it, weighted bilinearly; an occupied one stops it at its faces and sends out their radiance. Finer spaces
/// within are crossed by the same light: what enters them is that of the next coarser one at their border.
class Sweeper {
 public:
    /// Returns the radiance that comes from outside along a direction (the way that light goes).
    using Outside = std::function<glm::vec3(const glm::vec3& way)>;

    explicit Sweeper(const Space& space) : Sweeper(std::array{&space}) {}
    /// `spaces`: each lies in the one before it.
    explicit Sweeper(std::span<const Space* const> spaces);

    /// Begins with this radiance of the faces of each space, W/(sr m^2), the same in all directions.
    void begin(Directions directions, std::span<const std::span<const glm::vec3>> radiance, Outside outside);
    /// Sweeps along the next few directions. Returns false when all are done.
    bool advance();
    /// Returns the irradiance of all faces of a space, W/m^2, when advance() has returned false.
    std::vector<glm::vec3> irradiance(size_t space = 0) const;

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
    struct Level {
        const Space& space;
        std::optional<Border> border = {};  ///< none: nothing is around it
        std::array<Order, 3> orders = {};
        std::vector<std::array<Four, kSides>> radiance = {};  ///< by occupied voxel; w 1: the side has a face
        std::array<std::vector<Four>, kGroups> sums = {};     ///< by face
    };
    class Crossing;

    std::vector<Level> levels_;
    Directions directions_;
    Outside outside_;
    size_t done_ = 0;  ///< directions of each group
};

}  // namespace lucarne::gi::volume
