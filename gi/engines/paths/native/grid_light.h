#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/gather/upsample.h"
#include "gi/native/reflectance.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::paths::native {

/// The light of one place of a grid of pixels.
struct GridLight {
    glm::vec3 offset{0.0f};  ///< of its surface from the view's origin, m
    float shown = 0;         ///< 1; 0: there is no surface
    glm::vec3 normal{0.0f};
    glm::vec3 irradiance{0.0f};  ///< W/m^2
};

/// A picture that is lit between the pixels of a grid.
struct GridLitPicture {
    const CameraView& camera;
    std::span<const GBufferTexel> texels;
    const GatherGrid& grid;             ///< steps of at most kMostStep
    std::span<const GridLight> lights;  ///< by row and column of the grid
    const gi::native::DiffuseTables& reflectances;
    std::span<glm::vec4> radiance;
    /// The share of the four places about a pixel that has to lie on its surface. In corners light changes by
    /// much from pixel to pixel, and the pixels at their end are beyond all places of their surface.
    float least_share = 0;
};
inline constexpr uint32_t kMostStep = 4;

/// Adds to each pixel what its surface reflects of the irradiance that upsample() interpolates, without
/// writing down surfaces and light of all pixels in between. Returns the pixels for which no place counts, or
/// too few, in an order that is always the same.
std::vector<uint32_t> add_grid_light(const GridLitPicture& picture);

}  // namespace lucarne::gi::paths::native
