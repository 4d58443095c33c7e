#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/surface/surface_sample.h"

namespace lucarne::octree {

/// The tangent plane of a point at the rim of a curved surface.
struct BentRim {
    glm::vec3 normal{0.0f};  ///< unit
    float variance = 0;      ///< of the heights over the curved surface, unbiased
    Range layer{0, 0};       ///< heights of the neighbours over the tangent plane
};

/// Fits a surface that bends in one direction to the neighbours of a point, if they lie on one side of it.
/// The normal of their best plane is that in the middle of them, not that at the point, so the point's disc
/// would stick out of a sparse curved surface. Local polynomials give the normal at the end, too (jets:
/// Cazals and Pouget 2005, "Estimating differential quantities using polynomial fitting of osculating jets").
/// Returns nothing if points lie all around, or if the bend does not explain most of the heights over the
/// plane, as where the neighbours have several layers.
std::optional<BentRim> fit_bent_rim(const Patch& nearest, const SurfaceFit& plane);

}  // namespace lucarne::octree
