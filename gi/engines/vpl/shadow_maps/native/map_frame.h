#pragma once

#include <glm/vec4.hpp>

#include "gi/engines/vpl/vpl_light.h"
#include "gi/shared/frame.h"

namespace lucarne::gi::vpl::native {

/// The frame of a VPL's map, frame_about() in parabolic.glsl, and the map's centre.
struct MapFrame {
    glm::vec4 centre, normal, tangent, bitangent;
};
inline MapFrame frame_of(const VplLight& light) {
    const glm::vec4 n = light.normal;
    glm::vec3 tangent, bitangent;
    frame_about(xyz_of(n), tangent, bitangent);
    return {light.position + n * n.w, n, glm::vec4(tangent, 0), glm::vec4(bitangent, 0)};
}

}  // namespace lucarne::gi::vpl::native
