#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/engines/volume/sights.h"
#include "gi/engines/volume/space.h"
#include "gi/host_frame.h"

namespace lucarne::gi::volume {

/// Returns the irradiance, W/m^2, of a point of a surface from that of the faces: of those about it that look
/// its way and are nearly in its plane, interpolated bilinearly across each axis; the axes weigh as the
/// squares of the normal's components (McTaggart 2004, "Half-Life 2 / Valve source shading": an ambient
/// cube). Only faces count that border on the air before the point, `air`: from the middle of this cell those
/// before the faces are seen (`sights` of the same space). In w: 1 if faces were found, else 0.
glm::vec4 irradiance_at(const Space& space, std::span<const glm::vec3> irradiance, const SurfacePoint& at,
                        const glm::ivec3& air, Sights& sights);

/// Returns what pixels reflect of the irradiance of the faces (irradiance_at()), W/(sr m^2), row 0 on top; 0
/// where there is no surface. The air before a point is on the way to the viewer, or along the normal.
/// `levels`: the finest that holds a point counts; near its border more and more of the next coarser one.
/// `missing` counts surfaces about which there is no face.
std::vector<glm::vec4> read_back(std::span<const LitLevel> levels, std::span<const SurfacePoint> surfaces,
                                 std::span<const Material> materials, size_t& missing);

}  // namespace lucarne::gi::volume
