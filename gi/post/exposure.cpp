#include "gi/post/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

/// Returns log2 of the brightness that kClippedShare of the pixels with points exceed, relative to the
/// log-average; minus infinity if no pixel shows points.
Result<double> highlights(Device& device, const Buffer& radiance, const GBuffer& gbuffer, double log_mean,
                          const glm::vec3& balance) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/highlights.comp"));
    LUCARNE_ASSIGN(Buffer counted, device.buffer(post::kBrightnessBins * sizeof(uint32_t), "exposure"));
    counted.clear(0);
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    radiance.bind(post::kBindRadiance);
    counted.bind(post::kBindCounts);
    program->set("width", gbuffer.width);
    program->set("height", gbuffer.height);
    program->set_block("balance", std::array<float, 4>{balance.x, balance.y, balance.z, 0.0f});
    program->set("log_mean", static_cast<float>(log_mean));
    const auto blocks = [](uint32_t pixels) { return (pixels + post::kBlockSide - 1) / post::kBlockSide; };
    program->dispatch(blocks(gbuffer.width) * blocks(gbuffer.height));
    const auto counts = counted.download_all<uint32_t>(post::kBrightnessBins);
    uint64_t all = 0;
    for (const uint32_t count : counts) all += count;
    const double above = kClippedShare * static_cast<double>(all);
    double passed = 0;
    for (int bin = post::kBrightnessBins - 1; bin > 0 && all > 0; --bin) {
        const double count = counts[bin];
        // The place within the bin keeps the exposure from jumping by whole bins between pictures.
        if (passed + count > above)
            return (bin + 1 - (above - passed) / count - post::kBrightnessBins / 2) / post::kBinsPerStop;
        passed += count;
    }
    return -HUGE_VAL;
}

/// Returns the exposed radiance of grey that `curve` maps to kNearlyWhite.
double nearly_white(ToneMap curve) {
    const double wanted = std::pow((kNearlyWhite + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
    double low = 0, high = 1e4;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        const glm::vec3 grey(static_cast<float>(middle));
        (tone_curve(grey, static_cast<uint32_t>(curve), 0).x < wanted ? low : high) = middle;
    }
    return high;
}

/// Returns the compression that brings `brightness` down to `white`.
float compression_to(double white, double brightness) {
    double low = 0, high = 1e6;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        const double found = kHighlightKnee + std::log1p(middle * (brightness - kHighlightKnee)) / middle;
        (found > white ? low : high) = middle;
    }
    return static_cast<float>(high);
}

}  // namespace

Result<Exposure> automatic_exposure(Device& device, const Buffer& radiance, const GBuffer& gbuffer,
                                    ToneMap curve, const glm::vec3& balance) {
    const uint32_t pixels = gbuffer.width * gbuffer.height;
    LUCARNE_ASSIGN(const double mean, mean_of(device, radiance, pixels, 0.0f));
    const auto floor = static_cast<float>(mean * kDarkest);
    if (!(floor > 0)) return Exposure{0, 0, balance};
    LUCARNE_ASSIGN(const double log_mean, mean_of(device, radiance, pixels, floor));
    LUCARNE_ASSIGN(const double bright, highlights(device, radiance, gbuffer, log_mean, balance));
    const double by_mean = std::log2(kKey);
    const double white = nearly_white(curve);
    const double by_highlights = std::log2(white) - bright;
    const double above_mean = std::clamp(by_highlights, by_mean - kMostLowered, by_mean);
    const double excess = std::min(above_mean - by_highlights, kMostCompressed);
    return Exposure{above_mean - log_mean, excess > 0 ? compression_to(white, white * std::exp2(excess)) : 0,
                    balance};
}

Exposure between(const Exposure& a, const Exposure& b, double share) {
    if (share >= 1) return b;
    return {a.ev + (b.ev - a.ev) * share, glm::mix(a.compression, b.compression, static_cast<float>(share)),
            b.balance};
}

double log_average_exposure(std::span<const glm::vec4> radiance) {
    const double floor = mean_of(radiance, 0) * kDarkest;
    return floor > 0 ? std::log2(kKey) - mean_of(radiance, floor) : 0;
}

}  // namespace lucarne::gi
