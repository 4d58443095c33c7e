#include "gi/engines/direct/direct.h"

#include "gi/bounce_options.h"
#include "gi/gl_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"

namespace lucarne::gi {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info, &kOnlyBounce.info, &kLightResolution.info,
                                          &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "direct",
                           .description = "direct light with shadow maps",
                           .options = kOptions,
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
    GBuffer light_gbuffer_;  // reused for the view of each light in turn
};

Result<void> DirectEngine::render(Frame& frame) {
    if (frame.settings[kOnlyBounce] > 0) {  // this engine draws no indirect bounce
        frame.gl.radiance.clear(0);
        return {};
    }
    frame.times.begin("emission");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, false));
    frame.times.end();
    for (const LightView& from : light_views(frame, sky_.directions)) {
        frame.times.begin("light G-buffer");
        LUCARNE_TRY(rasterize(frame.gl.device, *from.cut, from.view, light_gbuffer_));
        frame.times.end();
        frame.times.begin("direct light");
        LUCARNE_TRY(add_light(frame, materials_, from, light_gbuffer_));
        frame.times.end();
    }
    return {};
}

}  // namespace

EngineEntry direct_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<DirectEngine>(); }};
}

}  // namespace lucarne::gi
