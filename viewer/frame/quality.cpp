#include "viewer/frame/quality.h"

#include <algorithm>
#include <cmath>

namespace lucarne::viewer {
namespace {

constexpr double kTooSlow = 1.5, kFast = 0.5;  ///< of the wanted time
constexpr double kLeastScale = 0.25;

}  // namespace

void MovingQuality::observe(double frame_seconds) {
    if (frame_seconds > kTooSlow * wanted_) {
        if (scale_ <= kLeastScale) reduced_ = true;
        // Assume that all time is spent on pixels. At most halve the scale at once, since one slow picture
        // may be an exception.
        scale_ = std::max(kLeastScale, scale_ * std::max(0.5, std::sqrt(wanted_ / frame_seconds)));
    } else if (frame_seconds < kFast * wanted_) {
        if (scale_ >= 1) reduced_ = false;
        scale_ = std::min(1.0, scale_ * 1.25);
    }
}

ImageSize scaled_size(ImageSize full, double scale) {
    const auto side = [&](uint32_t pixels) {
        return std::max(16u, static_cast<uint32_t>(std::lround(pixels * scale)));
    };
    return {side(full.width), side(full.height)};
}

void MovingQuality::reduce(gi::EngineSettings& settings, CutBudgets& budgets) const {
    if (!reduced_) return;
    const Preset& cheap = presets().front();
    for (const gi::OptionInfo* option : gi::engine_options()) {
        const gi::OptionValue& cheap_value = cheap.engine.get(*option);
        const double more = gi::number_of(cheap_value) - gi::number_of(settings.get(*option));
        if (option->cheaper * more > 0) settings.set(*option, cheap_value);
    }
    budgets.view = std::min(budgets.view, cheap.budgets.view);
    budgets.light_view = std::min(budgets.light_view, cheap.budgets.light_view);
    budgets.light = std::min(budgets.light, cheap.budgets.light);
    budgets.pixel_spacing = std::max(budgets.pixel_spacing, cheap.budgets.pixel_spacing);
}

}  // namespace lucarne::viewer
