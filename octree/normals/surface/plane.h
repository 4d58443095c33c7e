#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "octree/normals/normals.h"
#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// A least-squares plane: the principal axes of a neighbourhood (Hoppe et al. 1992, section 3.2).
struct Plane {
    glm::dvec3 normal{0.0};  ///< unit; the direction of least variance, its sign arbitrary
    std::array<double, 3>
        variances{};  ///< eigenvalues of the covariance, rising; variances[0] along the normal
};

/// What PCL's estimator gives for the points of which these are the sums (pcl_plane), without trigonometry.
Plane plane_of(const Moments& moments);

/// PCL's plane estimator: the mean and covariance, the closed-form eigenvectors, in double precision.
Plane pcl_plane(const Patch& patch);

/// By whichever goes with the search. At least three points.
Plane fit_plane(NeighbourSearch search, const Patch& patch);

}  // namespace lucarne::octree
