#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "gi/shared/brdf.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi::native {

/// The channels of albedos by their 10-bit codes (decode_albedo() in surfel_code.h), whose powers would take
/// most of the time of a picture.
inline const std::array<float, 1024>& linear_albedos() {
    static const std::array<float, 1024> kLinear = [] {
        std::array<float, 1024> values{};
        for (size_t code = 0; code < values.size(); ++code)
            values[code] = srgb_to_linear(static_cast<float>(code) / 1023.0f);
        return values;
    }();
    return kLinear;
}

/// Returns decode_albedo() of a code by that table.
inline glm::vec3 linear_albedo(uint32_t code) {
    const std::array<float, 1024>& linear = linear_albedos();
    return {linear[code & 1023u], linear[code >> 10 & 1023u], linear[code >> 20 & 1023u]};
}

/// Tables for the diffuse reflectance kd of texels, make_reflectance() in brdf.h.
struct DiffuseTables {
    std::array<float, 1024> linear;  ///< by the 10-bit code of a channel of PackedSurfel.d
    /// By material: what the albedo is multiplied by in each channel, and the largest kd.
    std::array<std::array<float, LUCARNE_DEVICE_MATERIALS>, 3> scale;
    std::array<float, LUCARNE_DEVICE_MATERIALS> most;

    /// `materials`: at least LUCARNE_DEVICE_MATERIALS.
    explicit DiffuseTables(std::span<const Material> materials) {
        linear = linear_albedos();
        for (size_t i = 0; i < LUCARNE_DEVICE_MATERIALS; ++i) {
            const glm::vec4& diffuse = materials[i].diffuse;
            scale[0][i] = diffuse.x;
            scale[1][i] = diffuse.y;
            scale[2][i] = diffuse.z;
            most[i] = std::min(kLargestAlbedo, 1.0f - std::clamp(diffuse.w, 0.0f, 1.0f));
        }
    }
};

}  // namespace lucarne::gi::native
