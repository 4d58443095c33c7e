#include "gi/engines/volume/volume.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "gi/bounce_options.h"
#include "gi/engines/volume/light_maker.h"
#include "gi/engines/volume/options.h"
#include "gi/engines/volume/read_back.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/traced_lights.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/lighting/light_options.h"

namespace lucarne::gi {
namespace volume {
namespace {

bool overlap(const Bounds& a, const Bounds& b) {
    const glm::vec3 common = glm::min(a.max, b.max) - glm::max(a.min, b.min);
    return common.x >= 0 && common.y >= 0 && common.z >= 0;
}

constexpr const OptionInfo* kOptions[] = {
    &kBounces.info,         &kOnlyBounce.info,   &kVoxelCount.info, &kVolumeLevels.info,
    &kSweepDirections.info, &kTransport.info,    &kIterations.info, &kShadows.info,
    &kLightResolution.info, &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "volume",
                           .label = "Light in a volume",
                           .description = "light carried through voxels: quick and even, without fine detail",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true}};

class VolumeEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;
    bool reads_light_cuts() const override { return maker_.running(); }

 protected:
    void update(const Changes& changes) override {
        scene_ = changes.scene;
        cuts_ = changes.light_cuts;
    }
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    Focus focus_of(const Frame& frame) const;
    Result<void> make_light(Frame& frame, bool in_parts);
    bool has_light(const Frame& frame) const;
    Result<void> show_light(Frame& frame);
    Result<void> add_direct(Frame& frame, bool any_state);

    Buffer materials_;
    Sky background_;
    GatherSky sky_;                   ///< what sweeps carry
    SkyDirections bright_;            ///< what is too bright for them
    std::optional<uint64_t> sky_of_;  ///< revision of the environment that both are made from
    std::vector<LightView> views_;    ///< of the lights and of what is bright in the sky
    LightGBuffers light_gbuffers_;
    LightCutTracer tracer_;
    LightMaker maker_;
    VolumeLight light_;
    SceneRevisions scene_;  ///< of the frame that is drawn
    LightCutRevisions cuts_;
    size_t missing_ = 0;  ///< pixels about which there is no face
};

Result<void> VolumeEngine::prepare(Frame& frame) {
    if (frame.gl.cuts.light_views.size() < frame.lights.size() || !frame.gl.cuts.light)
        return failed("volume", "the cuts of the light are missing");
    LUCARNE_TRY(upload_sky(frame, background_));
    if (sky_of_ != scene_.environment) {
        sky_ = gather_sky(frame.environment);
        bright_ = SkyDirections(sky_.bright);
        sky_of_ = scene_.environment;
    }
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

/// Returns where the levels about the camera are to be: where those of the light that is there are, as long
/// as that is near enough.
Focus VolumeEngine::focus_of(const Frame& frame) const {
    const bool sweeps = frame.settings[kTransport] == Transport::sweeps;
    const uint32_t levels = sweeps ? frame.settings[kVolumeLevels] : 1;
    if (levels == 1) return {};
    const glm::vec3 extent = frame.bounds.max - frame.bounds.min;
    const Focus now{levels, std::max({extent.x, extent.y, extent.z}), glm::vec3(frame.camera.origin),
                    glm::vec3(frame.camera.forward)};
    const bool same_place = light_.basis && light_.basis->scene.bounds == scene_.bounds;
    return same_place && light_.basis->focus.holds(now) ? light_.basis->focus : now;
}

/// Brings the light at the faces up to date; in parts, as far as the time of the frame allows.
Result<void> VolumeEngine::make_light(Frame& frame, bool in_parts) {
    Basis basis{scene_, frame.origin, frame.bounds, cuts_, {}, frame.index, focus_of(frame)};
    for (const LightView& view : views_) basis.lights.push_back(view.light);
    if (light_.basis == basis) {
        maker_.stop();
        return {};
    }
    if (!in_parts || !maker_.goes_on(basis)) maker_.begin(std::move(basis), frame.settings);
    LUCARNE_TRY(maker_.run(frame, {views_, light_gbuffers_, sky_},
                           in_parts ? frame.light_budget : StepBudget{}, light_));
    if (!in_parts) maker_.stop();  // what is left if the frame was given up
    return {};
}

/// Whether the light that was made last may be shown. The bounds may have changed: a scan grows, and its
/// light of a moment ago is better than none. That of a scan elsewhere is not.
bool VolumeEngine::has_light(const Frame& frame) const {
    return light_.basis && light_.basis->origin == frame.origin &&
           overlap(light_.basis->bounds, frame.bounds);
}

/// Sets the picture to what pixels reflect of the light that was made last.
Result<void> VolumeEngine::show_light(Frame& frame) {
    if (!has_light(frame)) {
        frame.gl.radiance.clear(0);
        return {};
    }
    const TimedPass pass(frame, "light of the volume");
    const auto surfaces = visible_surfaces(frame.camera, download_gbuffer(frame));
    upload_radiance(frame, read_back(light_.levels, surfaces, device_materials(frame.materials), missing_));
    return {};
}

/// Adds emission, background and the first reflection of the lights. `any_state`: shadows by maps may be
/// those of a moment ago.
Result<void> VolumeEngine::add_direct(Frame& frame, bool any_state) {
    Device& device = frame.gl.device;
    if (traces_shadows(frame)) LUCARNE_TRY(tracer_.update(frame, cuts_.light));
    const TimedPass pass(frame, "direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, background_, true));
    if (traces_shadows(frame)) {
        add_traced_light(frame, *tracer_, bright_);
        return {};
    }
    for (const LightView& view : views_) {
        LUCARNE_ASSIGN(const GBuffer* seen, any_state ? light_gbuffers_.look_at_any_state(device, view)
                                                      : light_gbuffers_.look(device, view));
        LUCARNE_TRY(add_light(frame, materials_, view, *seen));
    }
    return {};
}

Result<void> VolumeEngine::render(Frame& frame) {
    const bool direct = wants_direct(frame.settings), in_parts = frame.moving && !frame.light_budget.whole();
    views_ = light_views(frame, bright_, frame.index);
    light_gbuffers_.begin(frame.gl.device, views_, views_.size());
    missing_ = 0;
    if (wants_indirect(frame.settings) || (direct && !sky_.texels.empty())) {
        // A first picture without it would be black in a room by day.
        LUCARNE_TRY(make_light(frame, in_parts && has_light(frame)));
        if (frame.stopped()) return {};
        LUCARNE_TRY(show_light(frame));
    } else {
        frame.gl.radiance.clear(0);
        if (in_parts) LUCARNE_TRY(light_gbuffers_.renew(frame, views_));
    }
    return direct ? add_direct(frame, in_parts) : Result<void>{};
}

std::vector<std::pair<std::string, double>> VolumeEngine::stats() const {
    if (light_.levels.empty()) return {{"voxels", 0}};
    size_t cells = 0, occupied = 0, faces = 0;
    for (const LitLevel& level : light_.levels) {
        cells += level.space->grid().cells();
        occupied += level.space->voxels.occupied().size();
        faces += level.space->faces.all().size();
    }
    return {{"voxels", cells},
            {"occupied_voxels", occupied},
            {"faces", faces},
            {"lit_faces", maker_.lit_faces()},
            {"voxel_side", light_.levels.front().space->grid().voxel},
            {"finest_voxel_side", light_.levels.back().space->grid().voxel},
            {"flux_under_way", maker_.under_way()},
            {"pixels_without_faces", missing_}};
}

}  // namespace
}  // namespace volume

EngineEntry volume_engine() {
    return {volume::kInfo,
            []() -> std::unique_ptr<Engine> { return std::make_unique<volume::VolumeEngine>(); }};
}

}  // namespace lucarne::gi
