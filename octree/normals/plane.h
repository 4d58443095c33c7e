#pragma once

#include <array>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// A least-squares plane: the principal axes of a neighbourhood (Hoppe et al. 1992, section 3.2).
struct Plane {
    glm::dvec3 normal{0.0};  ///< unit; the direction of least variance, its sign arbitrary
    std::array<double, 3>
        variances{};  ///< eigenvalues of the covariance, rising; variances[0] along the normal
};

/// PCL's plane estimator (the mean and covariance, the closed-form eigenvectors), in double precision. Holds
/// its scratch: one a thread.
class PlaneFitter {
 public:
    PlaneFitter();
    ~PlaneFitter();
    /// `points` near the origin; at least three.
    Plane fit(std::span<const glm::vec3> points);

 private:
    struct Scratch;
    std::unique_ptr<Scratch> scratch_;
};

}  // namespace lucarne::octree
