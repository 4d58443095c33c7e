#pragma once

#include <glm/vec4.hpp>

#include "gi/engines/vpl/vpl_light.h"

namespace lucarne::gi::vpl::native {

/// The same as in parabolic.glsl.
inline constexpr float kSheetTolerance = 0.1f;

/// The frame of a VPL's map, frame_about() in parabolic.glsl (Duff et al. 2017), and the map's centre.
struct MapFrame {
    glm::vec4 centre, normal, tangent, bitangent;
};
inline MapFrame frame_of(const VplLight& light) {
    const glm::vec4 n = light.normal;
    const float s = n.z >= 0 ? 1.0f : -1.0f, a = -1 / (s + n.z), b = n.x * n.y * a;
    return {light.position + n * n.w, n, glm::vec4(1 + s * n.x * n.x * a, s * b, -s * n.x, 0),
            glm::vec4(b, s + n.y * n.y * a, -n.y, 0)};
}

}  // namespace lucarne::gi::vpl::native
