#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

/// A least-squares plane: the principal axes of a neighbourhood (Hoppe et al. 1992, section 3.2).
struct Plane {
    glm::dvec3 normal{0.0};  ///< unit; the direction of least variance, its sign arbitrary
    std::array<double, 3>
        variances{};  ///< eigenvalues of the covariance, rising; variances[0] along the normal
};

/// Computes the plane of the points whose sums are `moments`, by PCL: pcl::eigen33, which
/// pcl::solvePlaneParameters and thus pcl::NormalEstimation call, in double precision. If there are no
/// points, returns the plane z = 0.
Plane plane_of(const Moments& moments);

}  // namespace lucarne::octree
