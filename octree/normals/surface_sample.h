#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>

#include "octree/normals/plane.h"
#include "octree/normals/surface_share.h"

namespace lucarne::octree {

/// The deviation of points that are isolated or have too few neighbours: more of them would not help.
inline constexpr float kNoPlane = 1e9f;

/// What a point's neighbourhood says of the surface there.
struct SurfaceSample {
    glm::vec3 normal{0.0f};      ///< unit, sign arbitrary; zero where there is no plane at all
    float deviation = kNoPlane;  ///< standard error of the normal, radians
    float area = 0.0f;           ///< the location's share of the surface, kStrayArea in the air; 0: unknown
    /// At the rim of a sheet or of a patch denser than what is around it: the known neighbours leave the cell
    /// open. Its area_at_rim() counts, once cut by what else it wants.
    std::optional<ShareCell> rim;
    /// The point stands apart from its neighbours, in their plane: a sparse point beside a dense patch if the
    /// surface goes on beyond it, on all sides that are open; else a stray one.
    bool apart = false;
};

/// A normal whose standard error is larger is asked from more neighbours (3 degrees: what millimetres of
/// noise make at centimetres of spacing, and more than a picture forgives on flat walls) ...
inline constexpr float kGoodDeviation = 0.052f;
/// ... and marked as unstable if those do not help. 12 degrees: isotropic blobs of 64 points have 20 and
/// more, planes with noise equal to their spacing 4.
inline constexpr float kPoorDeviation = 0.26f;

/// From the offsets to the point itself (zero) and to its neighbours, nearest first, at most kMostSampled in
/// all; `area_count` is the usual number of them, whose reach tells the spacing. `whole_cloud`: there are no
/// further points, so that distances say nothing about isolation.
///  - The plane is PCL's. Where the neighbourhood falls apart into layers along the normal (both faces of a
///  thin
///    wall), only the point's own layer is used.
///  - The standard error of the normal is that of an eigenvector (Anderson 1963, theorem 1): with eigenvalues
///    l0 <= l1 <= l2 over n points, var = sum over i = 1, 2 of l0 li / (n (li - l0)^2), which grows without
///    bound for lines (l1 -> l0) and blobs (l2 -> l0) alike.
///  - The area is that of the point's cell among the neighbours in its layer (surface_share.h).
SurfaceSample sample_surface(std::span<const glm::vec3> offsets, size_t area_count, bool whole_cloud,
                             PlaneFitter& fitter);
inline constexpr size_t kMostSampled = 128;

}  // namespace lucarne::octree
