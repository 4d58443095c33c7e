#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {

/// Estimates normals by PCL's own estimator, pcl::NormalEstimationOMP, for comparison with ours. It uses
/// PCL's default search (FLANN's kd-tree) or ours, plugged in as a pcl::search::Search. The normals are unit
/// and face the origin; they are not finite where PCL finds none.
std::vector<glm::vec3> pcl_normals(std::span<const glm::vec3> points, int neighbours, NeighbourSearch search);

}  // namespace lucarne::octree
