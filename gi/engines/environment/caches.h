#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/gather/gatherer.h"
#include "gi/host_frame.h"

namespace lucarne::gi::environment {

/// Light that was gathered at a place, for pixels about it.
struct Cache {
    glm::vec3 position{0.0f}, normal{0.0f, 0.0f, 1.0f};
    float reach = 0;  ///< m; pixels farther away do not use it
    LightVectors light{};
};

/// Interpolates the light of pixels from caches (Harada 2014, section 3.5): each counts by how near it is and
/// how much its normal agrees (Ward et al. 1988, with the smooth weights of Tabellion & Lamorlette 2004), and
/// not at all if it is in front of the pixel's plane. Sets `light` of these `pixels`: the mean radiance for
/// their normals, W/(sr m^2). Returns those for which nothing counts; their light is left as it is.
std::vector<uint32_t> interpolate(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                                  std::span<const uint32_t> pixels, std::span<const Cache> caches,
                                  std::span<glm::vec4> light);

}  // namespace lucarne::gi::environment
