#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/surface/plane.h"
#include "octree/normals/surface/surface_sample.h"

namespace lucarne::octree {

/// Where the plane of a side meets another plane.
struct Crease {
    glm::vec3 other{0.0f};  ///< the normal of the other plane
    float offset = 0;       ///< other . x = offset on that plane; x is relative to the point
    bool rises = false;   ///< the other points lie on the side of the side's plane to which its normal points
    float roughness = 0;  ///< standard deviation of the other points from their plane
    float distance = 0;   ///< of the line, in the side's plane; 0: there is none
};

/// A side of a crease: the plane to which a point near the crease belongs.
struct Side {
    Plane plane;
    size_t count = 0;     ///< points of the patch on this side
    float variance = 0;   ///< of their heights over the plane, unbiased
    float deviation = 0;  ///< standard error of the normal, radians
    Range layer{0, 0};    ///< their heights over the tangent plane through the point
    Crease first;         ///< the nearer of the creases at which the side ends
    Crease second;        ///< another one, as at a corner or on a narrow face
    /// Unit, along the plane's normal: to a parallel plane nearby, such as the other face of a board; else
    /// zero.
    glm::vec3 layered{0.0f};
};

/// Finds the side of a crease on which a point lies. `whole`: the fit without creases. `spacing`: the
/// distance between points. Returns nothing if there is no crease, if there are too few points, or if the
/// side is not clearly flatter than the whole.
///
/// Every straight or bent crease near the point leaves a sector around the point that the crease does not cut
/// (as the sectors of an adaptive filter: Nagao and Matsuyama 1979; for points, a neighbourhood shifted away
/// from the crease: Cao et al. 2018). So the patch is divided into kSectors sectors about the point, planes
/// are fitted to all runs of kRun sectors, and the run whose points, and the point itself, lie closest to
/// their plane wins. Its plane is fitted again to all points that lie in it. The moments of sectors add up,
/// so all runs together cost little more than one fit.
std::optional<Side> fit_side(const Patch& patch, const SurfaceFit& whole, float spacing);

/// Finds the face on which a point lies between two creases that are near each other, as on the edge of a
/// board or on a moulding. No sector about the point is free of creases there. So planes through the point
/// and two of its `nearest` are tried (RANSAC, Fischler and Bolles 1981, with all pairs), and the one with
/// the most points of `patch` wins. `noisy_plane`: the point may lie in one rough plane, of which some parts
/// are flat.
std::optional<Side> fit_narrow_side(const Patch& nearest, const Patch& patch, const SurfaceFit& whole,
                                    float spacing, bool noisy_plane);

}  // namespace lucarne::octree
