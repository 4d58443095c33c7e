#pragma once

#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>

#include "gi/bake/precomputation.h"

namespace lucarne::gi::paint {

inline constexpr uint32_t kMeanSteps = 8;  ///< of the precomputation

/// The mean colour of the scan's surfaces, linear, weighted by area; finished or not.
struct MeanColour final : Bake {
    glm::dvec3 mean{0.0};
};

/// Sums the colours, an eighth of the surfels a step.
std::unique_ptr<Precomputation> sum_colours();

}  // namespace lucarne::gi::paint
