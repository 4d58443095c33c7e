#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/engines/paths/bake.h"
#include "gi/lighting/light_gbuffers.h"

namespace lucarne::gi::paths {

/// The light of lamps at entry points, by the lamps' shadow maps: E and V of Yue et al. 2007, eq. 8 and 9.
class EntryLight {
 public:
    /// Sends entry points to the device unless it has them. Errors: device memory.
    Result<void> set_entries(Frame& frame, std::span<const Entry> entries);
    /// Returns the irradiance of each entry point by all these views of lights, W/m^2. `any_state`: shadow
    /// maps of an earlier state of their cuts will do. Errors: device memory, a shader that fails.
    Result<std::vector<glm::vec3>> irradiance(Frame& frame, const std::vector<LightView>& views,
                                              LightGBuffers& gbuffers, bool any_state);

 private:
    const Entry* entries_ = nullptr;  ///< those on the device
    size_t count_ = 0;
    glm::vec3 offset_{0.0f};
    Buffer flat_, irradiance_;
};

}  // namespace lucarne::gi::paths
