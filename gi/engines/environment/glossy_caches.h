#pragma once

#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/engines/environment/caches.h"
#include "gi/frame.h"
#include "gi/host_frame.h"
#include "gi/shared/brdf.h"

namespace lucarne::gi::environment {

/// At most so many caches hold light by direction: 94 MB.
inline constexpr size_t kMostGlossyCaches = 32768;

/// Which lobes take their light from caches.
enum class CachedLobes : uint8_t {
    wide,  ///< those that are as wide as the cells of directions (LobeCells::kExactExponent)
    all,   ///< narrower ones look as wide as these; where no cache counts, lobes have the light of all sides
};

/// Adds to `light` what pixels reflect by lobes of the light that caches hold by direction, W/(sr m^2), each
/// cell of directions as far away as what its rays have met. It is found at one pixel of each square
/// (kGatherEvery), and between them by upsample(). `received`: the mean radiance of all directions at each
/// pixel. Sets the radius of those surfaces to 0 whose lobes have their light, or that have no lobe.
void reflect_by_caches(const Frame& frame, std::span<const Cache> caches, CachedLobes which,
                       std::span<const Reflectance> reflectances, std::span<const glm::vec4> received,
                       std::span<SurfacePoint> surfaces, std::span<glm::vec4> light);

}  // namespace lucarne::gi::environment
