#include "gi/engines/micro/micro.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "gi/bounce_options.h"
#include "gi/engines/micro/final_gather.h"
#include "gi/engines/micro/options.h"
#include "gi/engines/micro/radiosity.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace micro {
namespace {

constexpr const OptionInfo* kOptions[] = {
    &kBounces.info,        &kOnlyBounce.info,      &kMicroBuffer.info,  &kGatherEvery.info,
    &kRadiosityLevel.info, &kLightResolution.info, &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "micro",
                           .label = "Final gathering",
                           .description = "final gathering of the light of all surfels, on OpenCL",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true, .opencl = true},
                           .reports_progress = true};

constexpr uint32_t kLargestRadiositySide = 16;

class MicroEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;

 protected:
    void update(const Changes& changes) override;
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    /// What the light of the tree depends on.
    struct Basis {
        SceneRevisions scene;
        LightCutRevisions cuts;
        std::vector<Light>
            lights;  ///< of the views: samples of lights with a size differ from frame to frame
        bool operator==(const Basis&) const = default;
    };
    Result<void> make_light(Frame& frame);
    Result<void> add_direct(Frame& frame);

    ClDevice* opencl_ = nullptr;  ///< of the frame's device
    Gatherer gatherer_;
    Buffer materials_;
    Sky sky_;
    std::vector<LightView> views_;
    LightGBuffers light_gbuffers_;
    LitTree lit_;
    Radiosity radiosity_;
    SceneRevisions scene_;  ///< of the frame that is drawn
    LightCutRevisions cuts_;
    std::optional<uint64_t> tree_of_;  ///< revision of the light cut that the tree is made from
    std::optional<Basis> light_of_;
    GatherCounts counts_;
};

void MicroEngine::update(const Changes& changes) {
    scene_ = changes.scene;
    cuts_ = changes.light_cuts;
}

Result<void> MicroEngine::prepare(Frame& frame) {
    if (frame.gl.cuts.light_views.size() < frame.lights.size() || !frame.gl.cuts.light)
        return failed("micro", "the cuts of the light are missing");
    LUCARNE_ASSIGN(opencl_, frame.gl.device.opencl());
    LUCARNE_TRY(upload_sky(frame, sky_));
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

/// Brings tree and light up to date.
Result<void> MicroEngine::make_light(Frame& frame) {
    if (tree_of_ != cuts_.light) {
        const TimedPass pass(frame, "surfel tree");
        tree_of_.reset();
        light_of_.reset();
        LUCARNE_TRY(lit_.set_surfels(frame));
        LUCARNE_TRY(gatherer_.set_tree(*opencl_, lit_.tree()));
        tree_of_ = cuts_.light;
    }
    Basis basis{scene_, cuts_, {}};
    for (const LightView& view : views_) basis.lights.push_back(view.light);
    if (light_of_ == basis) return {};
    light_of_.reset();
    const EngineSettings& s = frame.settings;
    {
        const TimedPass pass(frame, "surfel light");
        LUCARNE_TRY(lit_.set_light(frame, views_, light_gbuffers_));
    }
    const bool only = s[kOnlyBounce] >= 0;
    const Radiosity::Settings settings{
        .bounces = (only ? static_cast<uint32_t>(s[kOnlyBounce]) : s[kBounces]) - 1,
        .only_last = only,
        .side = std::min(s[kMicroBuffer], kLargestRadiositySide),
        .seed = mix64(s[kSeed], frame.index)};
    const TimedPass pass(frame, "radiosity");
    if (settings.bounces > 0) radiosity_.choose_places(lit_, s[kRadiosityLevel]);
    std::vector<SideLight> light, slots;
    LUCARNE_TRY(radiosity_.compute(*opencl_, lit_, gatherer_, settings, light, frame.stop));
    if (frame.stopped()) return {};
    pull_light(lit_.tree(), light, slots);
    LUCARNE_TRY(gatherer_.set_light(*opencl_, slots));
    light_of_ = std::move(basis);
    return {};
}

/// Adds emission, background and the first reflection of the lights.
Result<void> MicroEngine::add_direct(Frame& frame) {
    const TimedPass pass(frame, "direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, true));
    for (const LightView& view : views_) {
        LUCARNE_ASSIGN(const GBuffer* seen, light_gbuffers_.look(frame.gl.device, view));
        LUCARNE_TRY(add_light(frame, materials_, view, *seen));
    }
    return {};
}

Result<void> MicroEngine::render(Frame& frame) {
    views_ = light_views(frame, sky_.directions);
    light_gbuffers_.begin(frame.gl.device, views_, views_.size());
    frame.gl.radiance.clear(0);
    if (wants_indirect(frame.settings)) {
        LUCARNE_TRY(make_light(frame));
        if (frame.stopped()) return {};
        LUCARNE_ASSIGN(const std::vector<glm::vec4> light,
                       gather_pixels(frame, *opencl_, gatherer_, counts_));
        if (frame.stopped()) return {};
        upload_radiance(frame, light);
    }
    if (frame.stopped() || !wants_direct(frame.settings)) return {};
    return add_direct(frame);
}

std::vector<std::pair<std::string, double>> MicroEngine::stats() const {
    return {{"tree_nodes", lit_.tree().nodes.size()},
            {"surfels", lit_.tree().leaves},
            {"radiosity_places", radiosity_.places()},
            {"gather_points", counts_.points},
            {"gathered_again", counts_.again}};
}

}  // namespace
}  // namespace micro

EngineEntry micro_engine() {
    return {micro::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<micro::MicroEngine>(); }};
}

}  // namespace lucarne::gi
