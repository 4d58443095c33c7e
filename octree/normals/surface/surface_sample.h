#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/surface/plane.h"

namespace lucarne::octree {

/// The deviation of points that are isolated or have too few neighbours: more of them would not help.
inline constexpr float kNoPlane = 1e9f;
/// A normal whose standard error is larger is asked from more neighbours (3 degrees: what millimetres of
/// noise make at centimetres of spacing, and more than a picture forgives on flat walls) ...
inline constexpr float kGoodDeviation = 0.052f;
/// ... and marked as unstable if those do not help. 12 degrees: isotropic blobs of 64 points have 20 and
/// more, planes with noise equal to their spacing 4.
inline constexpr float kPoorDeviation = 0.26f;

/// What a point's neighbourhood says of the surface there.
struct SurfaceFit {
    glm::vec3 normal{0.0f};      ///< unit, sign arbitrary
    float deviation = kNoPlane;  ///< standard error of the normal, radians
    Range layer{0, 0};           ///< heights over the plane of the point's own surface
    float roundness = 0;         ///< the middle variance over the largest: 0 for points on a line
};

/// Fits planes to neighbourhoods: patches with the point itself first, its neighbours after it. Holds its
/// scratch: one a thread.
class SurfaceFitter {
 public:
    /// At least four points.
    ///  - The plane is PCL's. Where the neighbourhood falls apart into layers along the normal (both faces of
    ///  a thin wall) by `spacing`, only the point's own layer is used.
    ///  - The standard error of the normal is that of an eigenvector (Anderson 1963, theorem 1): with
    ///  eigenvalues l0 <= l1 <= l2 over n points, var = sum over i = 1, 2 of l0 li / (n (li - l0)^2), which
    ///  grows without bound for lines (l1 -> l0) and blobs (l2 -> l0) alike.
    SurfaceFit fit(const Patch& patch, float spacing);
    /// Over the plane of the last fit.
    const std::vector<float>& heights() const { return heights_; }
    /// Whether the point lies in the plane of its neighbours as well as these do.
    bool lies_in_plane_of_others(const Patch& patch);

 private:
    std::vector<float> heights_;
    Patch layer_;
};

/// Whether the point hangs in the air, away from all surfaces, as its neighbours, nearest first, tell: the
/// nearest of the first `usual` is hardly nearer than the farthest, or the others stand much closer to each
/// other. `in_doubt`: its normal is uncertain.
bool is_stray(const Patch& nearest, size_t usual, bool in_doubt);
/// The share of the surface that the neighbours of a point in the air have: what it is to be drawn with,
/// having none of its own.
float share_of_neighbours(const Patch& nearest);
/// Whether a stray point is near enough to its neighbours to go on with their surface.
bool is_near_enough(const Patch& nearest);

}  // namespace lucarne::octree
