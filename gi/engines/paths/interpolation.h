#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/host_frame.h"

namespace lucarne::gi::paths {

/// Returns the irradiance at a surface point, W/m^2, from that of the gathering points about it
/// (`irradiance`, one each): the mean weighted by 1 - error_of(). `position` is in the bake's coordinates.
/// If no point reaches it, the light of the one with the smallest error is taken, and `alone` set; black if
/// there is none either.
glm::vec3 irradiance_at(const PathsBake& bake, std::span<const glm::vec3> irradiance,
                        const glm::vec3& position, const glm::vec3& normal, bool& alone);

/// Lets gathering points share their light with those about them, as pixels do: it takes the blotches of
/// their few rays away.
std::vector<glm::vec3> smooth(const PathsBake& bake, std::span<const glm::vec3> irradiance);

}  // namespace lucarne::gi::paths
