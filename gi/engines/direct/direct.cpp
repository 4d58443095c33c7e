#include "gi/engines/direct/direct.h"

#include "gi/bounce_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/lighting/light_options.h"

namespace lucarne::gi {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info, &kOnlyBounce.info, &kLightResolution.info,
                                          &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "direct",
                           .label = "Direct light",
                           .description = "direct light with shadow maps",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true},
                           .direct_only = true};

class DirectEngine : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 protected:
    Result<void> prepare(Frame& frame) override {
        if (frame.gl.cuts.light_views.size() < frame.lights.size())
            return failed("direct", "there are fewer light views than lights");
        LUCARNE_TRY(upload_sky(frame, sky_));
        return upload_materials(frame.gl.device, frame.materials, materials_);
    }
    Result<void> render(Frame& frame) override;

 private:
    Buffer materials_;
    Sky sky_;
    LightGBuffers light_gbuffers_;
    uint64_t light_index_ = 0;  ///< Frame::index by which lights with a size are sampled
};

Result<void> DirectEngine::render(Frame& frame) {
    if (!wants_direct(frame.settings)) {  // this engine draws no indirect bounce
        frame.gl.radiance.clear(0);
        return {};
    }
    frame.times.begin("emission");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, false));
    frame.times.end();
    // In motion shadows may be those of a moment ago; they are renewed as far as the time goes.
    const bool in_parts = frame.moving && !frame.light_budget.whole();
    if (!in_parts) light_index_ = frame.index;
    const std::vector<LightView> views = light_views(frame, sky_.directions, light_index_);
    Device& device = frame.gl.device;
    light_gbuffers_.begin(device, views, views.size());
    if (in_parts) LUCARNE_TRY(light_gbuffers_.renew(frame, views));
    for (const LightView& from : views) {
        if (frame.stopped()) return {};
        frame.times.begin("light G-buffer");
        LUCARNE_ASSIGN(const GBuffer* seen, in_parts ? light_gbuffers_.look_at_any_state(device, from)
                                                     : light_gbuffers_.look(device, from));
        frame.times.end();
        frame.times.begin("direct light");
        LUCARNE_TRY(add_light(frame, materials_, from, *seen));
        frame.times.end();
    }
    return {};
}

}  // namespace

EngineEntry direct_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<DirectEngine>(); }};
}

}  // namespace lucarne::gi
