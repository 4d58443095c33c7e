#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/tracing/alias_table.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::tracing {

/// Evenly distributed.
glm::vec3 point_on_disc(const Surfel& surfel, Random& random);

/// Draws surfels in proportion to weights, and points evenly on their discs, so that paths are led to
/// surfaces which are bright (next event estimation).
///
/// Discs overlap and noise puts them above each other, so what a ray toward such a point meets first is often
/// another disc. What is drawn is therefore a direction: it takes the light of whatever it meets, and counts
/// where the disc drawn is crossed by the ray up to some end that follows from the direction alone. Its
/// density is then the sum over all discs crossed up to there of P(disc) / (pi r^2) * d^2 / cos, which
/// divides the draw and weighs directions drawn in other ways (multiple importance sampling, Veach & Guibas
/// 1995). No property of the cloud is assumed: wrong weights, radii, areas, normals and positions change the
/// noise alone.
class SurfelSampler {
 public:
    /// One weight a surfel of `surfels`, which outlives this: finite, not negative.
    SurfelSampler(const SurfelTracer& surfels, std::span<const double> weights);

    bool empty() const { return table_.empty(); }  ///< all weights are 0

    struct Draw {
        uint32_t surfel;
        glm::vec3 point;  ///< on its disc
    };
    Draw draw(Random& random) const;  ///< of one that is not empty

    struct Density {
        float pdf = 0;         ///< 1/sr, with which draws that count take this direction
        bool crossed = false;  ///< whether `drawn` is among the discs crossed
    };
    /// Of a unit direction whose ray meets nothing before `begin` and ends at `end`, m.
    Density density(const glm::vec3& origin, const glm::vec3& direction, float begin, float end,
                    uint32_t drawn = kNoSurfel) const;

 private:
    const SurfelTracer* surfels_;
    AliasTable table_;
    std::vector<uint32_t> drawn_;  // surfels, in the order of table_
    std::vector<float> per_area_;  // of each surfel: its probability over its disc's area, 1/m^2
};

}  // namespace lucarne::gi::tracing
