#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Carries light through the volume as Gaitatzes 2012, section 5.5, does (after Kaplanyan & Dachsbacher 2010,
/// "Cascaded light propagation volumes"): each voxel of air holds an intensity in two bands of spherical
/// harmonics, and in each iteration passes it to its six neighbours. Mended: cones are those of the
/// neighbour's five other faces, so that no light is lost; lobes are never clamped, which would add light;
/// light that meets an occupied voxel arrives at the face before it; faces send out a cosine about their
/// normal into the air before them. It is still diffusion: two bands forget where light came from, and of
/// what a floor sends out hardly anything reaches a far ceiling.
class Propagation {
 public:
    explicit Propagation(const Space& space);

    /// Begins with this radiance of the faces, W/(sr m^2), the same in all directions.
    void begin(std::span<const glm::vec3> radiance, uint32_t iterations);
    /// Makes the next few iterations. Returns false when all are done.
    bool advance();
    /// Returns the irradiance of all faces, W/m^2, by what has arrived.
    std::vector<glm::vec3> irradiance() const;
    /// Returns the flux that is still in the air, W (red, green, blue).
    glm::vec3 under_way() const;
    /// Adds light of this flux, W, in the air at a cell: a cosine about `normal`.
    void inject(const glm::ivec3& cell, const glm::vec3& normal, const glm::vec3& flux);

 private:
    using Vector = float __attribute__((vector_size(16)));
    /// Intensity, W/sr, as factors of Y00 and of the three Y1 along x, y and z; r, g, b each.
    struct Lobe {
        std::array<Vector, 4> bands{};
    };
    /// How a lobe passes to the neighbour along +x: the factors of the bands there, of the bands here. All
    /// others are 0. For the neighbour along -x those between bands change their sign.
    struct Step {
        float flux_flux = 0;    ///< Y00 from Y00
        float flux_along = 0;   ///< Y00 from Y1 along x
        float along_flux = 0;   ///< Y1 along x from Y00
        float along_along = 0;  ///< Y1 along x from Y1 along x
        float side_side = 0;    ///< Y1 along y from Y1 along y, and likewise z
    };
    static Step make_step();
    template <size_t axis>
    void add_neighbours(const glm::ivec3& cell, uint32_t number, uint32_t stride, Lobe& sum) const;
    void iterate();

    const Space& space_;
    const Step step_;
    std::vector<Lobe> now_, next_;    ///< by cell
    std::vector<glm::vec3> arrived_;  ///< by face, W
    std::vector<uint32_t> cells_;     ///< by face: the cell before it; none if it is outside
    uint32_t left_ = 0;               ///< iterations
};

}  // namespace lucarne::gi::volume
