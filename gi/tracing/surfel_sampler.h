#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/tracing/alias_table.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::tracing {

/// Draws a point, evenly distributed on the disc of a surfel.
glm::vec3 point_on_disc(const Surfel& surfel, Random& random);

/// Draws surfels in proportion to weights, and points evenly on their discs, so that paths sample bright
/// surfaces (next event estimation).
///
/// Discs overlap, and noise puts them above each other, so a ray toward such a point often hits another disc
/// first. What is drawn is therefore a direction. It carries the light of whatever its ray hits, and counts
/// if the ray crosses the drawn disc before an end that depends on the direction alone. The density of a
/// direction is then the sum over all discs crossed before that end of P(disc) / (pi r^2) * d^2 / cos. It
/// divides the draw, and weighs directions drawn in other ways (multiple importance sampling, Veach & Guibas
/// 1995). The method assumes nothing about the cloud: wrong weights, radii, areas, normals and positions
/// only change the noise.
class SurfelSampler {
 public:
    /// `weights` has one weight per surfel of `surfels`, finite and not negative. `surfels` must outlive
    /// this.
    SurfelSampler(const SurfelTracer& surfels, std::span<const double> weights);

    bool empty() const { return table_.empty(); }  ///< true if all weights are 0

    struct Draw {
        uint32_t surfel;
        glm::vec3 point;  ///< on its disc
    };
    Draw draw(Random& random) const;  ///< the sampler must not be empty

    struct Density {
        float pdf = 0;         ///< density, 1/sr, of this direction among draws that count
        bool crossed = false;  ///< whether `drawn` is among the discs crossed
    };
    /// Returns the density of a unit direction whose ray hits nothing before `begin` and ends at `end`, m.
    Density density(const glm::vec3& origin, const glm::vec3& direction, float begin, float end,
                    uint32_t drawn = kNoSurfel) const;

 private:
    const SurfelTracer* surfels_;
    AliasTable table_;
    std::vector<uint32_t> drawn_;  // surfels, in the order of table_
    std::vector<float> per_area_;  // of each surfel: its probability over the area of its disc, 1/m^2
};

}  // namespace lucarne::gi::tracing
