#include "tests/added_engine/paint/paint.h"

#include "gi/host_frame.h"
#include "tests/added_engine/paint/bands.h"
#include "tests/added_engine/paint/mean_colour.h"
#include "tests/added_engine/paint/options.h"

namespace lucarne::gi {
namespace paint {
namespace {

constexpr const OptionInfo* kOptions[] = {&kTint.info,    &kGain.info,     &kWidth.info,
                                          &kPattern.info, &kPaintSky.info, &kMeanScale.info};
constexpr const OptionInfo* kOfBake[] = {&kMeanScale.info};
constexpr Precomputes kPrecomputes{.make = sum_colours, .colours = true, .options = kOfBake};
constexpr EngineInfo kInfo{.name = "paint",
                           .label = "Paint",
                           .description = "one colour",
                           .options = kOptions,
                           .needs = {.opencl = true},
                           .precomputes = &kPrecomputes};

class PaintEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override {
        return {{"finished", bands_.running() ? 0 : 1}};
    }

 protected:
    void update(const Changes& changes) override { settings_ = changes.scene.settings; }
    Result<void> prepare(Frame& frame) override {
        Basis basis{.settings = settings_};
        if (frame.bake) basis.mean = static_cast<const MeanColour*>(frame.bake)->mean;
        return bands_.prepare(frame, basis);
    }
    Result<void> render(Frame& frame) override {
        const bool in_parts = frame.moving && !frame.light_budget.whole();
        LUCARNE_TRY(bands_.run(frame, in_parts ? frame.light_budget : StepBudget{}));
        if (frame.stopped()) return {};
        paint_picture(frame);
        return {};
    }

 private:
    void paint_picture(Frame& frame) const {
        const EngineSettings& s = frame.settings;
        const auto texels = download_gbuffer(frame);
        std::vector<glm::vec4> radiance(texels.size(), glm::vec4(0.0f));
        for (size_t i = 0; i < texels.size() && bands_.finished(); ++i) {
            const bool striped =
                s[kPattern] == Pattern::stripes && i % frame.camera.width / s[kWidth] % 2 == 1;
            if ((texels[i].depth > 0 || s[kPaintSky]) && !striped)
                radiance[i] = (*bands_.finished())[i * kBands / texels.size()];
        }
        upload_radiance(frame, radiance);
    }

    Bands bands_;
    uint64_t settings_ = 0;  ///< revision, of the frame that is drawn
};

}  // namespace
}  // namespace paint

EngineEntry paint_engine() {
    return {paint::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<paint::PaintEngine>(); }};
}

PaintHooks& paint_hooks() {
    static PaintHooks hooks;
    return hooks;
}

}  // namespace lucarne::gi
