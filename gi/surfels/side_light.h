#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::gi {

/// Light of the two sides of a surface: of its front, the side of its axis or normal, and of its back.
/// Radiance that leaves it, W/(sr m^2), unless another quantity is named.
struct SideLight {
    glm::vec3 front{0.0f}, back{0.0f};
};

/// Light of many sides that several owners read: an OpenCL processor reads it where it is.
using SharedLight = std::shared_ptr<const std::vector<SideLight>>;
inline SharedLight shared(std::vector<SideLight> light) {
    return std::make_shared<const std::vector<SideLight>>(std::move(light));
}

/// Specular light that leaves sides, W/m^2, and where to (lobe.h); no elements where nothing is glossy.
struct SideLobes {
    std::vector<SideLight> light, directions;
};

}  // namespace lucarne::gi
