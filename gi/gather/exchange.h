#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/brdf.h"
#include "gi/surfels/side_light.h"

namespace lucarne::gi {

/// How light goes from lit surfels to all surfels, by photons or by VPLs.
struct ExchangeSettings {
    uint64_t sources = 0;    ///< how many photons or VPLs
    uint32_t bounces = 0;    ///< reflections beyond the light of lit surfels, at least one
    bool only_last = false;  ///< compute the light of the last one alone, else add it to that of the surfels
    uint64_t seed = 0;
};

/// What comes to a side of a surfel: its irradiance, W/m^2, and where mirrors would send it, unit vectors
/// each times the mean of the three colours of its irradiance.
struct Arrived {
    glm::vec3 irradiance{0.0f}, directions{0.0f};
};

/// Adds what a side of a surfel reflects to what the surfel sends out, evenly and by a lobe (lobe.h); no
/// lobes: nothing is glossy.
void add_reflected(const Reflectance& reflectance, const Arrived& arrived, uint32_t surfel, bool back,
                   std::vector<SideLight>& light, SideLobes& lobes);

/// Sets all light to 0.
void clear_light(std::vector<SideLight>& light, SideLobes& lobes);

}  // namespace lucarne::gi
