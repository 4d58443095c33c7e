#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::tracing {

/// Returns whether a point of the disc of a surfel is seen from straight above, and nothing is between it and
/// the disc's middle: what of a disc lies behind a wall is not a part of the surface. `normal` points away
/// from that side.
bool is_exposed(const SurfelTracer& tracer, size_t surfel, const glm::vec3& point, const glm::vec3& normal);

inline constexpr uint32_t kExposurePoints = 4;
inline constexpr uint32_t kUncovered = UINT32_MAX;
/// What is seen from straight above one side of a disc.
struct Exposure {
    uint32_t points = 0;  ///< of kExposurePoints of the disc, those that are exposed (is_exposed())
    /// What is close above the disc at the last point that is covered: twice the surfel, and one more if
    /// its back is seen.
    uint32_t cover = kUncovered;
};
struct Exposures {
    Exposure front, back;
};

/// Returns the exposures of each surfel. Discs overlap, and noise puts them above each other, so light meets
/// only a part of each. The exposed parts of all discs add up to the surface, whatever the surfels' own
/// shares of it. Gives up if `stop` becomes true.
std::vector<Exposures> exposures(const SurfelTracer& tracer, const std::atomic<bool>* stop = nullptr);

}  // namespace lucarne::gi::tracing
