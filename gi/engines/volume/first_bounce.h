#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/volume/native/look.h"
#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Gathers the light of bright faces at all faces. Lamps and the sun may light so little of a room that
/// sweeps along some directions would miss it, so here each face looks at all that are lit: at those nearby
/// one by one, at others in clusters that look small from there (a tree, as in Walter et al. 2005,
/// "Lightcuts", but opened by angle alone). Lines of sight go through air.
class FirstBounce {
 public:
    explicit FirstBounce(const Space& space);

    /// Begins with this radiance of the faces, W/(sr m^2), the same in all directions. `inner`: a grid within
    /// this space, or null.
    void begin(std::span<const glm::vec3> radiance, const Grid* inner = nullptr);
    /// Gathers at the next few faces. Returns false when all are done.
    bool advance();
    /// The irradiance of all faces, W/m^2, when advance() has returned false.
    std::span<const glm::vec3> irradiance() const { return irradiance_; }
    /// Likewise: that of faces in and about the inner grid by those outside of it; 0 at others.
    std::span<const glm::vec3> from_outside() const { return from_outside_; }

 private:
    void add_cluster(std::span<const glm::vec3> radiance, std::span<uint32_t> faces);
    size_t divide(std::span<uint32_t> faces) const;
    using Rays = std::vector<Ray>;
    void finish_nearby(const Receiver& face, Rays& rays) const;
    glm::vec3 take_brightest(uint32_t face, Rays& rays, float& share) const;
    glm::vec3 gather(uint32_t face, Rays& rays) const;

    const Space& space_;
    std::vector<glm::vec3> places_;  ///< by face: a place in the air before it, in units of voxels
    std::vector<Cluster>
        clusters_;  ///< two trees: of the faces outside of the inner grid, and of those in it
    size_t outer_clusters_ = 0;
    std::vector<uint8_t> apart_;  ///< by face: whether light from outside of the inner grid is kept apart
    std::vector<glm::vec3> irradiance_, from_outside_;
    std::vector<uint32_t> order_;  ///< faces by their sides: receivers that look the same way together
    size_t done_ = 0;              ///< of the order
};

/// Returns the form factor from a small surface at `position` with the unit `normal` to a square with this
/// middle, unit normal and area: the share of light that leaves the surface and arrives on the square's
/// front, if nothing is in between (Lambert 1760; the polygon formula of Baum et al. 1989, "Improving
/// radiosity solutions through the use of analytically determined form-factors", eq. 6).
float form_factor(const glm::vec3& position, const glm::vec3& normal, const glm::vec3& middle,
                  const glm::vec3& square_normal, float area);

}  // namespace lucarne::gi::volume
