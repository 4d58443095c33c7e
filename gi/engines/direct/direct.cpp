#include "gi/engines/direct/direct.h"

#include "gi/lighting/direct_light.h"

namespace lucarne::gi {
namespace {

class DirectEngine : public Engine {
 public:
    const EngineInfo& info() const override {
        static constexpr EngineInfo kInfo{"direct", "direct light with shadow maps"};
        return kInfo;
    }
    Result<void> prepare(Frame& frame) override {
        if (frame.cuts.light_views.size() < frame.lights.size())
            return failed("direct", "there are fewer light views than lights");
        LUCARNE_TRY(upload_sky(frame, sky_));
        return upload_materials(frame.device, frame.materials, materials_);
    }
    Result<void> render(Frame& frame) override;
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 private:
    Buffer materials_;
    Sky sky_;
    GBuffer light_gbuffer_;  // of one light's view after another
};

Result<void> DirectEngine::render(Frame& frame) {
    if (frame.settings.only_bounce > 0) {  // no bounce at all is drawn here
        frame.radiance.clear(0);
        return {};
    }
    frame.times.begin("emission");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, false));
    frame.times.end();
    for (const LightView& from : light_views(frame, sky_.directions)) {
        frame.times.begin("light G-buffer");
        LUCARNE_TRY(rasterize(frame.device, *from.cut, from.view, light_gbuffer_));
        frame.times.end();
        frame.times.begin("direct light");
        LUCARNE_TRY(add_light(frame, materials_, from, light_gbuffer_));
        frame.times.end();
    }
    return {};
}

}  // namespace

std::unique_ptr<Engine> make_direct_engine() {
    return std::make_unique<DirectEngine>();
}

}  // namespace lucarne::gi
