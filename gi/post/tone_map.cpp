#include "gi/post/tone_map.h"

#include <array>
#include <cmath>

#include <glm/vec3.hpp>

#include "gi/post/bindings.h"
#include "gi/shared/luminance.h"
#include "gi/shared/tone_curve.h"

namespace lucarne::gi {
namespace {

glm::vec3 scale_of(const Exposure& exposure) {
    return static_cast<float>(std::exp2(exposure.ev)) * exposure.balance;
}

}  // namespace

glm::vec3 white_balance(const glm::dvec3& white) {
    return glm::vec3(luminance(white) / white);
}

Result<void> tone_map(Device& device, const Buffer& radiance, uint32_t pixels, ToneMap curve,
                      const Exposure& exposure, Buffer& picture) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/tone_map.comp"));
    LUCARNE_TRY(device.reserve(picture, size_t{pixels} * sizeof(uint32_t), "picture"));
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    program->set("pixels", pixels);
    const glm::vec3 scale = scale_of(exposure);
    program->set_block("scale", std::array<float, 4>{scale.x, scale.y, scale.z, 0.0f});
    program->set("curve", static_cast<uint32_t>(curve));
    program->set("compression", exposure.compression);
    program->dispatch(pixels);
    return {};
}

std::vector<glm::vec4> tone_map(std::span<const glm::vec4> radiance, ToneMap curve,
                                const Exposure& exposure) {
    std::vector<glm::vec4> mapped;
    mapped.reserve(radiance.size());
    const glm::vec3 scale = scale_of(exposure);
    for (const glm::vec4& pixel : radiance)
        mapped.emplace_back(
            tone_curve(glm::vec3(pixel) * scale, static_cast<uint32_t>(curve), exposure.compression), 1.0f);
    return mapped;
}

}  // namespace lucarne::gi
