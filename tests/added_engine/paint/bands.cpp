#include "tests/added_engine/paint/bands.h"

#include <span>

#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "tests/added_engine/paint/options.h"
#include "tests/added_engine/paint/paint.h"

namespace lucarne::gi::paint {

Result<void> Bands::prepare(Frame& frame, const Basis& basis) {
    if (!opencl_) {
        LUCARNE_ASSIGN(opencl_, frame.gl.device.opencl());
        LUCARNE_ASSIGN(kernel_, opencl_->kernel("tests/added_engine/paint/bands.cl", "paint_band"));
        if (const auto calls = paint_hooks().opencl_losses.next()) opencl_->lose_after(*calls);
    }
    LUCARNE_TRY(opencl_->reserve(colours_, kBands * sizeof(glm::vec4), "colours of bands"));
    if (basis_ == basis) return {};
    basis_ = basis;
    std::vector<Step<const Frame>> steps;
    for (uint32_t band = 0; band < kBands; ++band)
        steps.push_back({"band", [this, band](const Frame& of) { return paint(of, band); }});
    steps.push_back({"show", [this](const Frame&) { return show(); }});
    runner_.start(std::move(steps));
    return {};
}

Result<void> Bands::run(Frame& frame, const StepBudget& budget) {
    const TimedPass pass(frame, "bands");
    auto taken = runner_.run(frame, budget, frame.stop);
    if (!taken) basis_.reset();  // a failed step has ended the others
    return taken;
}

Result<StepResult> Bands::paint(const Frame& frame, uint32_t band) {
    const EngineSettings& s = frame.settings;
    const Pattern pattern = s[kPattern];
    const glm::dvec3 colour = pattern == Pattern::mean ? basis_->mean.value_or(glm::dvec3(0)) : s[kTint];
    LUCARNE_TRY(kernel_->run(ClRange(1), colours_, band, glm::vec4(glm::vec3(colour * s[kGain]), 1.0f),
                             uint32_t{pattern == Pattern::grey}));
    return StepResult::done;
}

Result<StepResult> Bands::show() {
    std::array<glm::vec4, kBands> colours{};
    LUCARNE_TRY(colours_.download(0, std::as_writable_bytes(std::span(colours))));
    finished_ = colours;
    return StepResult::done;
}

}  // namespace lucarne::gi::paint
