#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// Finds where the only scanner of a scan stood, if the order of its points does not show it: the place above
/// the round hole that its tripod left in a floor, from which no point hides another. `points`: an even
/// sample, m; `below`: the middle of that hole. Returns none where there is no such place: scans from several
/// stations.
std::optional<glm::vec3> find_lone_station(std::span<const glm::vec3> points, const glm::vec3& below);

}  // namespace lucarne::octree
