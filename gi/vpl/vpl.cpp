#include "gi/vpl/vpl.h"

#include <algorithm>

#include <fmt/format.h>

#include "gi/gbuffer/direct_light.h"
#include "gi/vpl/light_sights.h"
#include "gi/vpl/redistribution.h"
#include "gi/vpl/shading.h"
#include "gi/vpl/shadow_maps.h"
#include "io/core/random.h"

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
    Sky sky_;
    LightSights sights_;
    Seeds seeds_;
    ShadowMaps maps_;
    Panes panes_;
    Redistribution redistribution_;
    bool indirect_ = false;  ///< the last frame had indirect light
    std::string said_left_out_;
};

bool wants_direct(const EngineSettings& s) {
    return s.only_bounce <= 0;
}
bool wants_indirect(const EngineSettings& s) {
    return s.only_bounce < 0 ? s.bounces > 0 : s.only_bounce > 0;
}

bool glossy(const Frame& frame) {
    return std::any_of(frame.materials.begin(), frame.materials.end(),
                       [](const Material& m) { return m.diffuse.w > 0; });
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
    warn_of_lights_left_out(frame, "vpl", said_left_out_);
    LUCARNE_TRY(upload_sky(frame, sky_));
    return upload_materials(frame.device, frame.materials, materials_);
}

/// VPLs on what the light sees, their shadow maps, interleaved shading; redistributed, the same again for the
/// next bounce: frame.radiance becomes the bounces asked for.
Result<void> VplEngine::light_indirectly(Frame& frame) {
    const EngineSettings& s = frame.settings;
    const uint32_t last = s.only_bounce < 0 ? s.bounces : static_cast<uint32_t>(s.only_bounce);
    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(s.atlas, s.vpls));
    const auto pass = [&](const char* name, auto&& body) -> Result<void> {
        frame.times.begin(name);
        auto done = body();
        frame.times.end();
        return done;
    };
    const bool shiny = glossy(frame);
    redistribution_.best_candidate = s.best_candidate;
    LUCARNE_TRY(pass("VPL join", [&] { return join_panes(frame, shiny, panes_); }));
    LUCARNE_TRY(pass("VPL seeding", [&] {
        return sights_.seed(frame, materials_, s.vpls, mix64(s.seed, frame.index), seeds_);
    }));
    LUCARNE_TRY(pass("ISM casters", [&] { return decode_casters(frame.device, *frame.cuts.light, maps_); }));
    for (uint32_t bounce = 1; bounce <= last; ++bounce) {
        LUCARNE_TRY(draw_shadow_maps(frame.device, *frame.cuts.light, seeds_, layout, bounce < last,
                                     frame.times, maps_));
        if (s.only_bounce < 0 || bounce == last)
            LUCARNE_TRY(
                pass("VPL shading", [&] { return shade_panes(frame, materials_, seeds_, maps_, panes_); }));
        if (bounce == last) break;
        const auto salt = static_cast<uint32_t>(mix64(mix64(s.seed, frame.index), bounce));
        LUCARNE_TRY(pass("VPL redistribution", [&] {
            return redistribute(frame.device, *frame.cuts.light, maps_, materials_, shiny, salt,
                                redistribution_, seeds_);
        }));
    }
    return pass("VPL merge", [&] { return merge_panes(frame, materials_, panes_); });
}

/// Emission, background and what the lights' first reflection sends to the eye.
Result<void> VplEngine::add_direct(Frame& frame) {
    frame.times.begin("direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, true));
    for (size_t i = 0; i < sights_.views().size(); ++i) {
        LUCARNE_ASSIGN(const GBuffer* seen, sights_.look(frame, i));
        LUCARNE_TRY(add_light(frame, materials_, sights_.views()[i], *seen));
    }
    frame.times.end();
    return {};
}

Result<void> VplEngine::render(Frame& frame) {
    sights_.begin(frame);
    frame.times.begin("light G-buffer");
    if (!sights_.views().empty()) LUCARNE_TRY(sights_.look(frame, 0));
    frame.times.end();
    indirect_ = wants_indirect(frame.settings) && (!sights_.views().empty() || emits(frame));
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
