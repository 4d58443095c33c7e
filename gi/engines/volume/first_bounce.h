#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

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
    /// A cluster of faces in preorder: its first child follows it, the second one after the first one's
    /// clusters.
    struct Cluster {
        glm::vec3 middle{0.0f};           ///< weighted by flux, m
        float radius = 0;                 ///< about the middle, of the sphere that holds all of its faces, m
        glm::vec3 low{0.0f}, high{0.0f};  ///< the box of its faces, m
        glm::vec3 normal{0.0f};           ///< mean, weighted by flux; shorter than 1 if normals differ
        float area = 0;                   ///< m^2
        glm::vec3 power{0.0f};            ///< sum of radiance * area, W/sr
        uint32_t face = 0;                ///< the one nearest to the middle, to which lines of sight go
        uint32_t faces = 0;
    };
    void add_cluster(std::span<const glm::vec3> radiance, std::span<uint32_t> faces);
    size_t divide(std::span<uint32_t> faces) const;
    static float farthest(const Cluster& cluster, const glm::vec3& position, const glm::vec3& along);
    /// What a cluster sends to a face if nothing is in between.
    struct Ray {
        glm::vec3 light;  ///< W/m^2
        float luminance;  ///< of the light
        uint32_t face;    ///< to which the line of sight goes
    };
    void look(const Face& face, size_t first, size_t last, std::vector<Ray>& rays) const;
    glm::vec3 take_brightest(uint32_t face, std::vector<Ray>& rays, float& share) const;
    glm::vec3 gather(uint32_t face, size_t first, size_t last, std::vector<Ray>& rays) const;

    const Space& space_;
    std::vector<glm::vec3> places_;  ///< by face: a place in the air before it, in units of voxels
    std::vector<Cluster>
        clusters_;  ///< two trees: of the faces outside of the inner grid, and of those in it
    size_t outer_clusters_ = 0;
    std::vector<uint8_t> apart_;  ///< by face: whether light from outside of the inner grid is kept apart
    std::vector<glm::vec3> irradiance_, from_outside_;
    size_t done_ = 0;
};

/// Returns the form factor from a small surface at `position` with the unit `normal` to a square with this
/// middle, unit normal and area: the share of light that leaves the surface and arrives on the square's
/// front, if nothing is in between (Lambert 1760; the polygon formula of Baum et al. 1989, "Improving
/// radiosity solutions through the use of analytically determined form-factors", eq. 6).
float form_factor(const glm::vec3& position, const glm::vec3& normal, const glm::vec3& middle,
                  const glm::vec3& square_normal, float area);

}  // namespace lucarne::gi::volume
