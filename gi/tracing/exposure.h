#pragma once

#include <cstdint>
#include <vector>

#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::tracing {

/// Returns whether a point of the disc of a surfel is seen from straight above; `normal` points away from
/// that side.
bool is_exposed(const SurfelTracer& tracer, size_t surfel, const glm::vec3& point, const glm::vec3& normal);

/// How many points of a disc are seen from straight above each of its sides, of kExposurePoints.
struct Exposure {
    uint8_t front = 0, back = 0;
};
inline constexpr uint32_t kExposurePoints = 4;

/// Returns the exposure of each surfel. Discs overlap, and noise puts them above each other, so light meets
/// only a part of each. The exposed parts of all discs add up to the surface, whatever the surfels' own
/// shares of it.
std::vector<Exposure> exposures(const SurfelTracer& tracer);

}  // namespace lucarne::gi::tracing
