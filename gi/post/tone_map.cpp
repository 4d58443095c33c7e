#include "gi/post/tone_map.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/post/bindings.h"
#include "gi/shared/luminance.h"
#include "gi/shared/tone_curve.h"

namespace lucarne::gi {
namespace {

constexpr double kKey = 0.18;
// Pixels darker than this share of the mean look black and say nothing about the exposure.
constexpr double kDarkest = 1.0 / 1024;

/// Returns the mean over the lit pixels of what luminance.comp sums; 0 if none is lit.
Result<double> mean_of(Device& device, const Buffer& radiance, uint32_t pixels, float floor) {
    constexpr uint32_t kRun = 256;
    const uint32_t parts = (pixels + kRun - 1) / kRun;
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/luminance.comp"));
    LUCARNE_ASSIGN(const Buffer sums, device.buffer(parts * sizeof(glm::vec2), "exposure"));
    radiance.bind(post::kBindRadiance);
    sums.bind(post::kBindSums);
    program->set("pixels", pixels);
    program->set("run", kRun);
    program->set("floor_luminance", floor);
    program->dispatch(parts);
    glm::dvec2 total(0.0);
    for (const glm::vec2& sum : sums.download_all<glm::vec2>(parts)) total += glm::dvec2(sum);
    return total.y > 0 ? total.x / total.y : 0.0;
}

/// The same on the host, as luminance.comp computes it with this `floor`.
double mean_of(std::span<const glm::vec4> radiance, double floor) {
    double sum = 0, count = 0;
    for (const glm::vec4& pixel : radiance) {
        const double value = luminance(glm::dvec3(pixel));
        if (!(value > 0) || std::isinf(value)) continue;
        sum += floor > 0 ? std::log2(std::max(value, floor)) : value;
        ++count;
    }
    return count > 0 ? sum / count : 0;
}

}  // namespace

Result<double> automatic_exposure(Device& device, const Buffer& radiance, uint32_t pixels) {
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
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    program->set("pixels", pixels);
    program->set("scale", static_cast<float>(std::exp2(ev)));
    program->set("curve", static_cast<uint32_t>(curve));
    program->dispatch(pixels);
    return {};
}

double automatic_exposure(std::span<const glm::vec4> radiance) {
    const double floor = mean_of(radiance, 0) * kDarkest;
    return floor > 0 ? std::log2(kKey) - mean_of(radiance, floor) : 0;
}

std::vector<glm::vec4> tone_map(std::span<const glm::vec4> radiance, ToneMap curve, double ev) {
    std::vector<glm::vec4> mapped;
    mapped.reserve(radiance.size());
    const auto scale = static_cast<float>(std::exp2(ev));
    for (const glm::vec4& pixel : radiance)
        mapped.emplace_back(tone_curve(glm::vec3(pixel) * scale, static_cast<uint32_t>(curve)), 1.0f);
    return mapped;
}

}  // namespace lucarne::gi
