#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "octree/normals/plane.h"

namespace lucarne::octree {

/// The deviation of points that are isolated or have too few neighbours: more of them would not help.
inline constexpr float kNoPlane = 1e9f;

/// What a point's neighbourhood says of the surface there.
struct SurfaceSample {
    glm::vec3 normal{0.0f};      ///< unit, sign arbitrary; zero where there is no plane at all
    float deviation = kNoPlane;  ///< standard error of the normal, radians
    float area = 0.0f;           ///< the location's share of the surface (in the air: its neighbours'); 0: unknown
};

/// A normal whose standard error is larger is asked from more neighbours (3 degrees: what millimetres of
/// noise make at centimetres of spacing, and more than a picture forgives on flat walls) ...
inline constexpr float kGoodDeviation = 0.052f;
/// ... and marked as unstable if those do not help. 12 degrees: isotropic blobs of 64 points have 20 and
/// more, planes with noise equal to their spacing 4.
inline constexpr float kPoorDeviation = 0.26f;

/// From the offsets to the point itself (zero) and to its neighbours, nearest first, at most kMostSampled in
/// all. The area is taken from the first `area_count` of them, however many the normal is from, so that
/// surfaces that need many are not favoured. `whole_cloud`: there are no further points, so that distances
/// say nothing about isolation.
///  - The plane is PCL's. Where the neighbourhood falls apart into layers along the normal (both faces of a
///  thin
///    wall), only the point's own layer is used.
///  - The standard error of the normal is that of an eigenvector (Anderson 1963, theorem 1): with eigenvalues
///    l0 <= l1 <= l2 over n points, var = sum over i = 1, 2 of l0 li / (n (li - l0)^2), which grows without
///    bound for lines (l1 -> l0) and blobs (l2 -> l0) alike.
///  - The area of a Poisson process in the plane follows from the distance d of the k-th neighbour: pi d^2 /
///  k, which
///    is unbiased (pi d^2 times the density is Gamma(k) distributed: Thompson 1956). Where noise lifts
///    neighbours by h along the normal, the ball cuts a smaller disc out of their layer, and each counts with
///    the inverse of it (Horvitz, Thompson 1952): area = pi / sum over neighbours of 1 / (d^2 - h^2).
SurfaceSample sample_surface(std::span<const glm::vec3> offsets, size_t area_count, bool whole_cloud,
                             PlaneFitter& fitter);
inline constexpr size_t kMostSampled = 128;

}  // namespace lucarne::octree
