#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/surface/plane.h"

namespace lucarne::octree {

/// The deviation where there is no plane: points that are isolated or have too few neighbours.
inline constexpr float kNoPlane = 1e9f;
/// A normal with a larger standard error is estimated again from more neighbours. 3 degrees is what
/// millimetres of noise cause at centimetres of spacing, and more is visible on flat walls.
inline constexpr float kGoodDeviation = 0.052f;
/// A normal whose error stays larger is marked as unstable. 15 degrees: isotropic blobs of 64 points have 20
/// and more, planes with noise equal to their spacing have 4.
inline constexpr float kPoorDeviation = 0.26f;

/// Returns the standard error of the normal of a plane through `points` points: that of an eigenvector
/// (Anderson 1963, theorem 1). With eigenvalues l0 <= l1 <= l2 over n points,
///     var = sum over i = 1, 2 of l0 li / (n (li - l0)^2).
/// It grows without bound both for lines (l1 -> l0) and for blobs (l2 -> l0).
float deviation_of(const Plane& plane, size_t points);

/// What a point's neighbourhood tells about the surface there.
struct SurfaceFit {
    glm::vec3 normal{0.0f};      ///< unit, sign arbitrary
    float deviation = kNoPlane;  ///< standard error of the normal, radians
    Range layer{0, 0};           ///< heights, over the plane, of the point's own surface
    float variance = 0;          ///< of the heights over the plane, unbiased
    float roundness = 0;         ///< the middle variance divided by the largest: 0 for points on a line
};

/// Fits planes to neighbourhoods: patches that start with the point itself. Holds scratch memory: use one per
/// thread.
class SurfaceFitter {
 public:
    /// Fits a plane to at least four points.
    ///  - The plane is PCL's. Where the neighbourhood separates into layers along the normal (the two faces
    /// of a thin wall), judged by `spacing`, only the point's own layer is used.
    SurfaceFit fit(const Patch& patch, float spacing);
    /// Heights over the plane of the last fit.
    const std::vector<float>& heights() const { return heights_; }
    /// Whether the point lies in the plane of its neighbours as well as they do themselves. The standard
    /// error of the plane's normal is at most `most_deviation`, radians.
    bool lies_in_plane_of_others(const Patch& patch, float most_deviation = kGoodDeviation);

 private:
    std::vector<float> heights_;
    Patch layer_;
};

/// Whether the point is an outlier in the air, away from all surfaces, judged by its neighbours (nearest
/// first): either the nearest of the first `usual` is hardly nearer than the farthest, or the neighbours are
/// much closer to each other than to the point. `in_doubt`: its normal is uncertain.
bool is_stray(const Patch& nearest, size_t usual, bool in_doubt);
/// Whether is_stray(), in doubt, may be true for a point with more neighbours than `nearest`: judged by a few
/// of `window`, all points within a radius in any order. Much cheaper than finding the nearest of them.
bool may_stand_apart(const Patch& nearest, const Patch& window);
/// Returns the typical share of the surface of the neighbours of a point in the air. The point is drawn with
/// it, because it has none of its own.
float share_of_neighbours(const Patch& nearest);
/// Whether an isolated point is near enough to its neighbours to belong to their surface.
bool is_near_enough(const Patch& nearest, float most_apart);

}  // namespace lucarne::octree
