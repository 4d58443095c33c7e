#include "gi/engines/unlit/unlit.h"

#include <algorithm>

#include "gi/engines/unlit/bindings.h"
#include "gi/gl_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {
namespace {

/// How much a light beside the eye counts: what faces away from it is .35 times as bright.
constexpr float kRelief = .65f;

constexpr EngineInfo kInfo{
    .name = "unlit",
    .label = "Scan colours",
    .description = "the points' colours without light: flat, eye-dome lighting, ambient occlusion or relief",
    .unlit = true};

class UnlitEngine : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 protected:
    Result<void> prepare(Frame& frame) override {
        LUCARNE_TRY(upload_sky(frame, sky_));
        return upload_materials(frame.gl.device, {}, materials_);
    }
    Result<void> render(Frame& frame) override;

 private:
    Result<void> obscure(Frame& frame);

    Buffer materials_;  // a single material without emission
    Sky sky_;
    Buffer obscurance_;  // float a pixel
};

/// Computes the ambient occlusion of every pixel, before smoothing.
Result<void> UnlitEngine::obscure(Frame& frame) {
    const GBuffer& gbuffer = frame.gl.gbuffer;
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    LUCARNE_TRY(frame.gl.device.reserve(obscurance_, pixels * sizeof(float), "ambient occlusion"));
    LUCARNE_ASSIGN(const Program* program, frame.gl.device.program("gi/engines/unlit/occlusion.comp"));
    gbuffer.texels.bind_texels(unlit::kUnitTexels, TexelView::four_words);
    obscurance_.bind(unlit::kBindObscurance);
    set(*program, "camera", frame.camera);
    program->set("reach", static_cast<float>(frame.unlit.occlusion_reach / 100));
    program->set("relief", frame.unlit.shading == Shading::relief ? kRelief : 0.0f);
    program->dispatch(gbuffer.width, gbuffer.height);
    return {};
}

Result<void> UnlitEngine::render(Frame& frame) {
    frame.times.begin("background");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, false));
    frame.times.end();
    const Shading shading = frame.unlit.shading;
    const bool occluded = shading == Shading::occlusion || shading == Shading::relief;
    if (occluded) {
        frame.times.begin("ambient occlusion");
        LUCARNE_TRY(obscure(frame));
        frame.times.end();
    }
    frame.times.begin("colours");
    static const Defines kDefines[] = {
        {}, {{"LUCARNE_EYE_DOME", "1"}}, {{"LUCARNE_OCCLUSION", "1"}}, {{"LUCARNE_OCCLUSION", "1"}}};
    LUCARNE_ASSIGN(const Program* program, frame.gl.device.program("gi/engines/unlit/colours.comp",
                                                                   kDefines[static_cast<size_t>(shading)]));
    frame.gl.gbuffer.texels.bind_texels(unlit::kUnitTexels, TexelView::four_words);
    if (occluded) obscurance_.bind(unlit::kBindObscurance);
    frame.gl.radiance.bind(unlit::kBindRadiance);
    set(*program, "camera", frame.camera);
    program->set("strength", static_cast<float>(frame.unlit.strength));
    program->set("brightness", static_cast<float>(frame.unlit.brightness));
    const double pixels = frame.unlit.eye_dome_pixels * frame.camera.height / 1080.0;
    program->set("neighbour", static_cast<float>(std::max(pixels, 1.0)));
    program->dispatch(frame.gl.gbuffer.width, frame.gl.gbuffer.height);
    frame.times.end();
    return {};
}

}  // namespace

EngineEntry unlit_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<UnlitEngine>(); }};
}

}  // namespace lucarne::gi
