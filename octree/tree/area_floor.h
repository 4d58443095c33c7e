#pragma once

#include <array>
#include <span>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Computes the floors of a node's surfel areas (octree/tree/footprint.h), for prefixes of 1, 1/2, 1/4 and
/// 1/8 of its own points (count/2^i, at least one). A floor is the least c >= 0 such that
///     sum over inherited and prefix points of max(area_i, c) = surface.
/// This c is the dual variable of a projection onto a simplex (Held, Wolfe, Crowder 1974), found by selection
/// in linear expected time. It is 0 where the areas alone exceed the surface, and surface/n where all areas
/// are unknown (0). It never decreases from one prefix to the next shorter one. Areas that are not positive
/// and finite count as unknown. `inherited_areas` are those of the ancestors' points inside the node's cube.
std::array<float, kPrefixSteps> area_floors(std::span<const float> inherited_areas,
                                            std::span<const float> own_areas_in_prefix_order, double surface);

/// Returns an area as nodes store it: at most the largest float, and not negative. NaN gives 0.
float stored_area(double area);
/// Converts floors in squares of `edge` to squares of the unit, as a directory stores them.
std::array<float, kPrefixSteps> stored_floors(const std::array<float, kPrefixSteps>& floors, double edge);

}  // namespace lucarne::octree
