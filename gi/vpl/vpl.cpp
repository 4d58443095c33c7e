#include "gi/vpl/vpl.h"

#include <algorithm>

#include <fmt/format.h>

#include "gi/gbuffer/direct_light.h"
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
    Result<void> add_direct(Frame& frame);
    Result<void> light_indirectly(Frame& frame);

    Buffer materials_;
    std::vector<GBuffer> seen_;  ///< by each light: its G-buffer and its shadow map
    Seeds seeds_;
    ShadowMaps maps_;
    Panes panes_;
    bool indirect_ = false;  ///< the last frame had indirect light
    bool said_first_bounce_ = false, said_first_light_ = false;
    std::string said_left_out_;
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

size_t first_spot(const Frame& frame) {
    const auto found = std::find_if(frame.lights.begin(), frame.lights.end(), casts_shadow_map);
    return static_cast<size_t>(found - frame.lights.begin());
}

const EngineInfo& VplEngine::info() const {
    static constexpr EngineInfo kInfo{"vpl", "virtual point lights with imperfect shadow maps"};
    return kInfo;
}

Result<void> VplEngine::prepare(Frame& frame) {
    const EngineSettings& s = frame.settings;
    if (s.interleave != 1 && s.interleave != 2 && s.interleave != 4)
        return bad_arguments("vpl", fmt::format("it cannot interleave {0} x {0} pixels", s.interleave),
                             "choose 1, 2 or 4");
    LUCARNE_TRY(atlas_layout(s.atlas, s.vpls));
    if (frame.cuts.light_views.size() < frame.lights.size())
        return failed("vpl", "there are fewer light views than lights");
    if (!said_first_bounce_ && (s.only_bounce > 1 || (s.only_bounce < 0 && s.bounces > 1))) {
        log::warn("vpl: light beyond the first bounce is not computed");
        said_first_bounce_ = true;
    }
    warn_of_lights_left_out(frame, "vpl", said_left_out_);
    if (!said_first_light_ && std::count_if(frame.lights.begin(), frame.lights.end(), casts_shadow_map) > 1 &&
        wants_indirect(s)) {
        log::warn("vpl: indirect light comes from the first spot alone");
        said_first_light_ = true;
    }
    return upload_materials(frame.device, frame.materials, materials_);
}

/// VPLs on what the light sees, their shadow maps, interleaved shading: frame.radiance becomes the first
/// bounce. Another bounce will put new VPLs in the place of these and repeat the last two, adding up the
/// panes.
Result<void> VplEngine::light_indirectly(Frame& frame) {
    const EngineSettings& s = frame.settings;
    const size_t first = first_spot(frame);
    const Light& spot = frame.lights[first];
    frame.times.begin("VPL seeding");
    LUCARNE_TRY(seed_lights(frame.device, spot, spot_view(spot, s.light_resolution),
                            *frame.cuts.light_views[first], seen_[first], materials_,
                            halton_points(s.vpls, s.seed, frame.index), seeds_));
    frame.times.end();
    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(s.atlas, s.vpls));
    LUCARNE_TRY(draw_shadow_maps(frame.device, *frame.cuts.light, seeds_, layout, frame.times, maps_));
    return shade_panes(frame, materials_, seeds_, maps_, glossy(frame), panes_);
}

/// Emission, background and what the lights' first reflection sends to the eye.
Result<void> VplEngine::add_direct(Frame& frame) {
    frame.times.begin("direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, true));
    for (size_t i = 0; i < frame.lights.size(); ++i)
        if (casts_shadow_map(frame.lights[i]))
            LUCARNE_TRY(add_spot_light(frame, materials_, frame.lights[i], seen_[i]));
    frame.times.end();
    return {};
}

Result<void> VplEngine::render(Frame& frame) {
    seen_.resize(frame.lights.size());
    frame.times.begin("light G-buffer");
    for (size_t i = 0; i < frame.lights.size(); ++i)
        if (casts_shadow_map(frame.lights[i]))
            LUCARNE_TRY(rasterize(frame.device, *frame.cuts.light_views[i],
                                  spot_view(frame.lights[i], frame.settings.light_resolution), seen_[i]));
    frame.times.end();
    indirect_ = wants_indirect(frame.settings) && first_spot(frame) < frame.lights.size();
    if (indirect_)
        LUCARNE_TRY(light_indirectly(frame));
    else
        frame.radiance.clear(0);
    return wants_direct(frame.settings) ? add_direct(frame) : Result<void>{};
}

std::vector<std::pair<std::string, double>> VplEngine::stats() const {
    if (!indirect_) return {{"vpls", 0}};
    return {{"vpls", maps_.layout.maps}, {"ism_side", maps_.layout.side}};
}

}  // namespace
}  // namespace vpl

std::unique_ptr<Engine> make_vpl_engine() {
    return std::make_unique<vpl::VplEngine>();
}

}  // namespace lucarne::gi
