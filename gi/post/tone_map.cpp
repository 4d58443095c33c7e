#include "gi/post/tone_map.h"

#include <cmath>

#include <glm/vec2.hpp>

namespace lucarne::gi {
namespace {

/// Mean over the pixels that are lit, of what luminance.comp sums; 0 where none is.
Result<double> mean_of(Device& device, const Buffer& radiance, uint32_t pixels, float floor) {
    constexpr uint32_t kRun = 256;
    const uint32_t parts = (pixels + kRun - 1) / kRun;
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/luminance.comp"));
    LUCARNE_ASSIGN(const Buffer sums, device.buffer(parts * sizeof(glm::vec2), "exposure"));
    radiance.bind(0);
    sums.bind(1);
    program->set("pixels", pixels);
    program->set("run", kRun);
    program->set("floor_luminance", floor);
    program->dispatch(parts);
    glm::dvec2 total(0.0);
    for (const glm::vec2& sum : sums.download_all<glm::vec2>(parts)) total += glm::dvec2(sum);
    return total.y > 0 ? total.x / total.y : 0.0;
}

}  // namespace

Result<double> automatic_exposure(Device& device, const Buffer& radiance, uint32_t pixels) {
    constexpr double kKey = 0.18;
    // What is darker than this share of the mean is black to the eye and says nothing about the exposure.
    constexpr double kDarkest = 1.0 / 1024;
    LUCARNE_ASSIGN(const double mean, mean_of(device, radiance, pixels, 0.0f));
    const auto floor = static_cast<float>(mean * kDarkest);
    if (!(floor > 0)) return 0.0;
    LUCARNE_ASSIGN(const double log_mean, mean_of(device, radiance, pixels, floor));
    return std::log2(kKey) - log_mean;
}

Result<void> tone_map(Device& device, const Buffer& radiance, uint32_t pixels, ToneMap curve, double ev,
                      Buffer& picture) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/tone_map.comp"));
    LUCARNE_TRY(device.reserve(picture, size_t{pixels} * sizeof(uint32_t), "picture"));
    radiance.bind(0);
    picture.bind(1);
    program->set("pixels", pixels);
    program->set("scale", static_cast<float>(std::exp2(ev)));
    program->set("curve", static_cast<uint32_t>(curve));
    program->dispatch(pixels);
    return {};
}

}  // namespace lucarne::gi
