#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/environment.h"

namespace lucarne::gi {

/// An environment in two parts: one that the few rays of a micro-buffer find, and one that they would miss.
struct GatherSky {
    uint32_t width = 0, height = 0;  ///< 0: dark
    float rotation = 0;              ///< as Environment::rotation
    std::vector<glm::vec3> texels;   ///< mean radiance of each texel, W/(sr m^2), rows from the zenith down
    /// What is brighter than most of the sky, such as a sun in a picture: for light views. Null: nothing.
    std::shared_ptr<const Environment> bright;

    /// Returns the radiance of `texels` from a unit direction, W/(sr m^2). The sky must not be dark.
    glm::vec3 radiance(const glm::vec3& direction) const;
};

/// Divides an environment, so that the sum of both parts is all of its light. Null is dark.
GatherSky gather_sky(const std::shared_ptr<const Environment>& environment);

}  // namespace lucarne::gi
