#include "gi/vpl/vpl.h"

#include <algorithm>

#include <fmt/format.h>

#include "gi/vpl/bindings.h"
#include "gi/vpl/constants.h"
#include "gi/vpl/halton.h"
#include "gi/vpl/seeding.h"
#include "gi/vpl/shading.h"
#include "gi/vpl/shadow_maps.h"
#include "io/core/log.h"

namespace lucarne::gi {
namespace vpl {
namespace {

class VplEngine : public Engine {
 public:
    const EngineInfo& info() const override;
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;
    std::vector<std::pair<std::string, double>> stats() const override;

 private:
    Result<void> upload_constants(Frame& frame);
    Result<void> light_scene(Frame& frame);

    Buffer materials_, constants_;
    GBuffer light_gbuffer_;
    Seeds seeds_;
    ShadowMaps maps_;
    Panes panes_;
    bool lit_ = false;  ///< the last frame had indirect light
    bool said_first_bounce_ = false, said_first_light_ = false;
};

bool wants_direct(const EngineSettings& s) {
    return s.only_bounce <= 0;
}
bool wants_indirect(const EngineSettings& s) {
    return s.only_bounce < 0 ? s.bounces > 0 : s.only_bounce == 1;
}

bool glossy(const Frame& frame) {
    return std::any_of(frame.materials.begin(), frame.materials.end(),
                       [](const Material& m) { return m.diffuse.w > 0; });
}

const EngineInfo& VplEngine::info() const {
    static constexpr EngineInfo kInfo{"vpl", "virtual point lights with imperfect shadow maps (Preiner 2010)"};
    return kInfo;
}

Result<void> VplEngine::prepare(Frame& frame) {
    const EngineSettings& s = frame.settings;
    if (s.interleave != 1 && s.interleave != 2 && s.interleave != 4)
        return bad_arguments("vpl", fmt::format("an interleave of {} is not 1, 2 or 4", s.interleave));
    LUCARNE_TRY(atlas_layout(s.atlas, s.vpls));
    if (!said_first_bounce_ && (s.only_bounce > 1 || (s.only_bounce < 0 && s.bounces > 1))) {
        log::warn("vpl: light beyond the first bounce is not computed");
        said_first_bounce_ = true;
    }
    if (!said_first_light_ && frame.lights.size() > 1) {
        log::warn("vpl: indirect light comes from the first of {} lights", frame.lights.size());
        said_first_light_ = true;
    }
    return {};
}

/// What all passes read: materials (never none) and the frame's constants, left bound.
Result<void> VplEngine::upload_constants(Frame& frame) {
    std::vector<Material> materials = frame.materials;
    if (materials.empty()) materials.push_back({glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)});
    LUCARNE_TRY(frame.device.reserve(materials_, materials.size() * sizeof(Material), "materials"));
    LUCARNE_TRY(frame.device.reserve(constants_, sizeof(FrameConstants), "frame constants"));
    materials_.upload_all(materials);
    FrameConstants constants{};
    constants.camera = frame.camera;
    if (!frame.lights.empty()) {
        constants.spot = frame.lights[0];
        constants.light_view = spot_view(frame.lights[0], frame.settings.light_resolution);
    }
    constants.background = glm::vec4(frame.background, 0.0f);
    constants_.upload(0, std::as_bytes(std::span(&constants, 1)));
    materials_.bind(kBindMaterials);
    constants_.bind(kBindConstants);
    return {};
}

/// From the light to the panes: light G-buffer, VPLs, shadow maps, interleaved shading. Another bounce will put new
/// VPLs in the place of these and repeat the last two, adding to the panes (checklist 1, pass 6).
Result<void> VplEngine::light_scene(Frame& frame) {
    const EngineSettings& s = frame.settings;
    Device& device = frame.device;
    frame.times.begin("light G-buffer");
    LUCARNE_TRY(rasterize(device, *frame.cuts.light_views[0], spot_view(frame.lights[0], s.light_resolution),
                          light_gbuffer_));
    frame.times.end();

    frame.times.begin("VPL seeding");
    LUCARNE_TRY(upload_constants(frame));
    LUCARNE_TRY(seed_lights(device, light_gbuffer_, halton_points(s.vpls, s.seed, frame.index), seeds_));
    frame.times.end();

    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(s.atlas, s.vpls));
    const auto salt = static_cast<uint32_t>(mix64(s.seed, frame.index));
    LUCARNE_TRY(draw_shadow_maps(device, *frame.cuts.light, seeds_.lights, layout, salt, frame.times, maps_));

    frame.times.begin("VPL shading");
    LUCARNE_TRY(upload_constants(frame));
    LUCARNE_TRY(shade_panes(frame, seeds_, maps_, glossy(frame), panes_));
    frame.times.end();
    return {};
}

Result<void> VplEngine::render(Frame& frame) {
    lit_ = wants_indirect(frame.settings) && !frame.lights.empty() && frame.cuts.light && !frame.cuts.light_views.empty();
    if (lit_) LUCARNE_TRY(light_scene(frame));
    frame.times.begin("merge");
    LUCARNE_TRY(upload_constants(frame));
    MergeInput input;
    if (lit_) input = {&seeds_, &maps_, &panes_, glossy(frame)};
    input.direct = wants_direct(frame.settings);
    LUCARNE_TRY(merge_panes(frame, input));
    frame.times.end();
    return {};
}

std::vector<std::pair<std::string, double>> VplEngine::stats() const {
    if (!lit_) return {{"vpls", 0}};
    return {{"vpls", maps_.layout.maps},
            {"ism_side", maps_.layout.side},
            {"ism_levels", maps_.layout.levels}};
}

}  // namespace
}  // namespace vpl

std::unique_ptr<Engine> make_vpl_engine() {
    return std::make_unique<vpl::VplEngine>();
}

}  // namespace lucarne::gi
