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
    Result<void> add_direct(Frame& frame, const std::vector<LightView>& views, const LightView* seeds);
    Result<void> light_indirectly(Frame& frame, const LightView& from);

    Buffer materials_;
    Sky sky_;
    GBuffer seen_[2];  ///< by the light that VPLs are seeded from, and by one view after another
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

/// The view that VPLs are seeded from: of the first spot.
const LightView* first_spot(const Frame& frame, const std::vector<LightView>& views) {
    const auto found = std::ranges::find_if(
        views, [&](const LightView& v) { return frame.lights[v.light].kind == kSpotLight; });
    return found == views.end() ? nullptr : &*found;
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
    if (!said_first_light_ && frame.lights.size() > 1 && wants_indirect(s)) {
        log::warn("vpl: indirect light comes from the first spot alone");
        said_first_light_ = true;
    }
    LUCARNE_TRY(upload_sky(frame, sky_));
    return upload_materials(frame.device, frame.materials, materials_);
}

/// VPLs on what the light sees, their shadow maps, interleaved shading: frame.radiance becomes the first
/// bounce. Another bounce will put new VPLs in the place of these and repeat the last two, adding up the
/// panes.
Result<void> VplEngine::light_indirectly(Frame& frame, const LightView& from) {
    const EngineSettings& s = frame.settings;
    frame.times.begin("VPL seeding");
    LUCARNE_TRY(seed_lights(frame.device, frame.lights[from.light], from.view,
                            *frame.cuts.light_views[from.light], seen_[0], materials_,
                            halton_points(s.vpls, s.seed, frame.index), seeds_));
    frame.times.end();
    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(s.atlas, s.vpls));
    LUCARNE_TRY(draw_shadow_maps(frame.device, *frame.cuts.light, seeds_, layout, frame.times, maps_));
    return shade_panes(frame, materials_, seeds_, maps_, glossy(frame), panes_);
}

/// Emission, background and what the lights' first reflection sends to the eye. `seeds` is the view that
/// seen_[0] holds.
Result<void> VplEngine::add_direct(Frame& frame, const std::vector<LightView>& views,
                                   const LightView* seeds) {
    frame.times.begin("direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, true));
    for (const LightView& from : views) {
        GBuffer& seen = seen_[&from == seeds ? 0 : 1];
        if (&from != seeds)
            LUCARNE_TRY(rasterize(frame.device, *frame.cuts.light_views[from.light], from.view, seen));
        LUCARNE_TRY(add_light(frame, materials_, from, seen));
    }
    frame.times.end();
    return {};
}

Result<void> VplEngine::render(Frame& frame) {
    const std::vector<LightView> views = light_views(frame);
    const LightView* seeds = wants_indirect(frame.settings) ? first_spot(frame, views) : nullptr;
    indirect_ = seeds != nullptr;
    if (seeds) {
        frame.times.begin("light G-buffer");
        LUCARNE_TRY(rasterize(frame.device, *frame.cuts.light_views[seeds->light], seeds->view, seen_[0]));
        frame.times.end();
        LUCARNE_TRY(light_indirectly(frame, *seeds));
    } else {
        frame.radiance.clear(0);
    }
    return wants_direct(frame.settings) ? add_direct(frame, views, seeds) : Result<void>{};
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
