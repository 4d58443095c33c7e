#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/gather/traced_tree.h"
#include "gi/surfels/side_light.h"

namespace lucarne::gi {

/// A virtual point light: a disc that stands for a part of the lit surface and shines with its light, so what
/// is near to it is not too bright.
struct VirtualLight {
    glm::vec3 position, normal, origin;  ///< origin: where rays to it end, above its surfel
    glm::vec3 even;                      ///< radiance, W/(sr m^2)
    glm::vec3 lobe, directions;          ///< or a specular lobe (lobe.h)
    float radius2 = 0;                   ///< m^2
};

/// Returns `count` VPLs in proportion to the light that leaves surfels, evenly (`light`) and by lobes, both
/// by surfel of the light cut; in the order of the tree, and so even over lit surfaces. They stand where
/// nothing covers a surfel. Fewer if there are fewer places, none where it is dark. The same arguments give
/// the same VPLs.
std::vector<VirtualLight> place_vpls(const TracedTree& traced, std::span<const SideLight> light,
                                     const SideLobes& lobes, uint64_t count, uint64_t seed);

/// Returns the irradiance, W/m^2, by a VPL that nothing hides of a point with this normal. Points of one
/// plane do not light each other; `radius` is that of the point's surfel.
glm::vec3 irradiance_by(const VirtualLight& vpl, const glm::vec3& position, const glm::vec3& normal,
                        float radius);

}  // namespace lucarne::gi
