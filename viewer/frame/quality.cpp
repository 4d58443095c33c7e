#include "viewer/frame/quality.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucarne::viewer {
namespace {

constexpr double kAim = 0.7, kFast = 0.5;  ///< of the longest time
constexpr double kLeastScale = 0.25;

}  // namespace

void MovingQuality::observe(double frame_seconds) {
    last_[next_++ % last_.size()] = frame_seconds;
    std::array<double, kObserved> sorted = last_;
    const auto known = std::min(next_, sorted.size());
    const auto middle = sorted.begin() + static_cast<ptrdiff_t>((known - 1) / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<ptrdiff_t>(known));
    if (*middle > longest_) {
        if (scale_ <= kLeastScale) reduced_ = true;
        // Assume that all time is spent on pixels. At most halve the scale at once, since some time is not.
        scale_ = std::max(kLeastScale, scale_ * std::max(0.5, std::sqrt(kAim * longest_ / *middle)));
        next_ = 0;  // pictures of another size tell nothing about this one
    } else if (*middle < kFast * longest_ && known == last_.size()) {
        if (scale_ >= 1) reduced_ = false;
        scale_ = std::min(1.0, scale_ * 1.2);
        next_ = 0;
    }
}

ImageSize scaled_size(ImageSize full, double scale) {
    const auto side = [&](uint32_t pixels) {
        return std::max(16u, static_cast<uint32_t>(std::lround(pixels * scale)));
    };
    return {side(full.width), side(full.height)};
}

void MovingQuality::reduce(gi::EngineSettings& settings, CutBudgets& budgets) const {
    const Preset& dearest = presets()[1];
    for (const gi::OptionInfo* option : gi::engine_options()) {
        const gi::OptionValue& value = dearest.engine.get(*option);
        const double more = gi::number_of(value) - gi::number_of(settings.get(*option));
        if (option->cheaper * more > 0) settings.set(*option, value);
    }
    const CutBudgets& most = reduced_ ? presets().front().budgets : dearest.budgets;
    budgets.view = std::min(budgets.view, most.view);
    budgets.light_view = std::min(budgets.light_view, most.light_view);
    budgets.light = std::min(budgets.light, most.light);
    budgets.pixel_spacing = std::max(budgets.pixel_spacing, most.pixel_spacing);
}

}  // namespace lucarne::viewer
