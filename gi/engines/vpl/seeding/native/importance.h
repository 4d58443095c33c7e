#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"

namespace lucarne::gi::vpl::native {

/// A light's view and its G-buffer.
struct ImportanceInput {
    const Light& light;
    uint32_t face;  ///< of the light, which the view shows
    const CameraView& view;
    const GBufferTexel* texels;
    std::span<const Material> materials;  ///< LUCARNE_DEVICE_MATERIALS, none of them with a lobe
    uint32_t side;                        ///< of level 0, a power of two
};

/// Computes all levels of the importance map, as importance.comp and importance_mip.comp do.
void map_importance(const ImportanceInput& input, std::span<glm::vec2> levels);

}  // namespace lucarne::gi::vpl::native
