#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {

/// Normals by PCL's own estimator, pcl::NormalEstimationOMP: over the search it takes by default (FLANN's
/// kd-tree), or over ours, plugged in as a pcl::search::Search. What our stage is compared with. Unit, toward
/// the origin; not finite where PCL gives none.
std::vector<glm::vec3> pcl_normals(std::span<const glm::vec3> points, int neighbours, NeighbourSearch search);

}  // namespace lucarne::octree
