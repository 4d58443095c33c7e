#include "gi/engines/vpl/lighting_maker.h"

#include <algorithm>
#include <utility>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/footprints.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/engines/vpl/options.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "io/core/random.h"

namespace lucarne::gi::vpl {
namespace {

// Bytes of maps that are kept from frame to frame: sixteen bounces of `interactive`, one of `high`.
constexpr size_t kMostKept = size_t{64} << 20;
// Of small steps: maps, and how many times fewer candidates for the VPLs.
constexpr uint32_t kMapsOfStep = 64, kFewerCandidates = 4;

/// Returns the part of a basis on which casters and importance depend.
Basis without_lights(Basis basis) {
    basis.scene.lights = 0;
    basis.cuts.light_views.clear();
    return basis;
}

/// Turns work that is done in one go into a step.
template <class Body>
auto step(Body body) {
    return [body = std::move(body)](auto& work) -> Result<StepResult> {
        LUCARNE_TRY(body(work));
        return StepResult::done;
    };
}

}  // namespace

uint32_t last_bounce(const EngineSettings& settings) {
    return settings[kOnlyBounce] < 0 ? settings[kBounces] : static_cast<uint32_t>(settings[kOnlyBounce]);
}

bool keeps_bounces(const AtlasLayout& layout, uint32_t last) {
    return layout.texels() * sizeof(uint32_t) * last <= kMostKept;
}

void LightingMaker::begin(Basis basis) {
    basis_ = std::move(basis);
    last_ = last_bounce(basis_.settings);
    maps_done_ = 0;
    drawn_views_ = 0;
    const bool known = looked_ == without_lights(basis_);
    std::vector<Step<Work>> steps;
    steps.push_back({"casters", [this, known](Work& work) { return decode_or_skip(work, known); }});
    if (!known) {
        steps.push_back({"importons", step([this](Work& work) {
                             if (work.frame.settings[kViewVpls]) basis_.camera = work.frame.camera;
                             return place_importons(work.frame, work.inputs);
                         })});
        steps.push_back({"further importons", step([this](Work& work) -> Result<void> {
                             LUCARNE_TRY(place_further_importons(work.frame, work.inputs));
                             looked_ = without_lights(basis_);
                             return {};
                         })});
    }
    steps.push_back({"light views", [this](Work& work) { return draw_light_view(work); }});
    steps.push_back({"seeds", step([this](Work& work) { return seed(work); })});
    steps.push_back({"importance", step([this](Work& work) {
                         return choose_seeds(work.frame, work.target.bounces[0].seeds);
                     })});
    for (uint32_t bounce = 1; bounce <= last_; ++bounce) add_bounce(bounce, steps);
    runner_.start(std::move(steps));
}

void LightingMaker::add_bounce(uint32_t bounce, std::vector<Step<Work>>& steps) {
    steps.push_back({"maps", [this, bounce](Work& work) { return draw_maps(work, bounce); }});
    steps.push_back({"closing", step([this, bounce](Work& work) -> Result<void> {
                         LUCARNE_TRY(with_atlas(work.target, bounce, [&] {
                             return close_maps(work.frame, work.target.bounces[bounce - 1].seeds);
                         }));
                         if (bounce == last_) work.target.basis = basis_;
                         return work.inputs.made ? work.inputs.made(bounce) : Result<void>();
                     })});
    if (bounce == last_) return;
    steps.push_back({"races", [this, bounce](Work& work) { return race(work, bounce); }});
    steps.push_back({"combination", step([this, bounce](Work& work) { return combine(work, bounce); })});
}

bool LightingMaker::goes_on(const Basis& now) const {
    Basis same = basis_;
    same.camera = now.camera;
    same.scene.lights = now.scene.lights;
    same.scene.environment = now.scene.environment;
    same.cuts.light_views = now.cuts.light_views;
    return running() && same == now;
}

Result<void> LightingMaker::look(Frame& frame, const Inputs& inputs, const Basis& basis) {
    if (looked_ == without_lights(basis)) return {};
    looked_.index = UINT64_MAX;  // invalid until everything is done
    LUCARNE_TRY(decode(frame));
    LUCARNE_TRY(place_importons(frame, inputs));
    LUCARNE_TRY(place_further_importons(frame, inputs));
    looked_ = without_lights(basis);
    return {};
}

Result<void> LightingMaker::run(Frame& frame, const Inputs& inputs, const StepBudget& budget,
                                Lighting& target) {
    Work work{frame, inputs, target};
    return runner_.run(work, budget, frame.stop);
}

/// Calls `draw` while `maps_` has the bounce's atlas.
template <class Draw>
Result<void> LightingMaker::with_atlas(Lighting& target, uint32_t bounce, const Draw& draw) {
    Buffer& atlas = target.bounces[keeps_bounces(target.layout, last_) ? bounce - 1 : 0].atlas;
    std::swap(maps_.atlas, atlas);
    const auto done = draw();
    std::swap(maps_.atlas, atlas);
    return done;
}

/// Decodes the casters, unless they are `known`.
Result<StepResult> LightingMaker::decode_or_skip(Work& work, bool known) {
    Lighting& target = work.target;
    LUCARNE_ASSIGN(target.layout, atlas_layout(work.frame.settings[kAtlas], work.frame.settings[kVpls]));
    target.basis.index = UINT64_MAX;
    target.is_united = false;
    target.bounces.resize(last_);
    if (known) return StepResult::skipped;
    looked_.index = UINT64_MAX;
    LUCARNE_TRY(decode(work.frame));
    return StepResult::done;
}

/// Draws the G-buffer of one light view that is missing; otherwise they are drawn when VPLs are placed.
Result<StepResult> LightingMaker::draw_light_view(Work& work) {
    // As many as there are: one that a moving light has may be missing in every frame.
    const std::vector<LightView> views = light_views_of(work.frame, work.inputs);
    if (!work.inputs.small_steps || drawn_views_ == views.size()) return StepResult::skipped;
    const TimedPass pass(work.frame, "light G-buffer");
    LUCARNE_ASSIGN(const bool drawn, work.inputs.light_gbuffers.draw_missing(work.frame.gl.device, views));
    ++drawn_views_;
    return drawn ? StepResult::again : StepResult::skipped;
}

Result<void> LightingMaker::decode(Frame& frame) {
    return timed(frame, "ISM casters",
                 [&] { return decode_casters(frame.gl.device, *frame.gl.cuts.light, maps_); });
}

Result<void> LightingMaker::place_importons(Frame& frame, const Inputs& inputs) {
    if (!frame.settings[kViewVpls]) return {};
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    return view_importance_.look(frame, inputs.materials, seed, maps_);
}

Result<void> LightingMaker::place_further_importons(Frame& frame, const Inputs& inputs) {
    sky_ = inputs.sky;
    openings_.clear();
    if (!frame.settings[kViewVpls]) return {};
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    LUCARNE_TRY(view_importance_.look_further(frame, inputs.materials, seed, maps_));
    if (sky_.dark()) return {};
    LUCARNE_ASSIGN(openings_, view_importance_.openings(frame.gl.device));
    sky_.favour(openings_);
    return {};
}

std::vector<LightView> LightingMaker::light_views_of(const Frame& frame, const Inputs& inputs) const {
    return light_views(frame, sky_, inputs.light_index);
}

/// Places the VPLs of the first bounce, or candidates for them.
Result<void> LightingMaker::seed(Work& work) {
    Frame& frame = work.frame;
    const Inputs& inputs = work.inputs;
    basis_.scene.lights = inputs.now.scene.lights;
    basis_.cuts.light_views = inputs.now.cuts.light_views;
    const EngineSettings& s = frame.settings;
    const uint64_t seed = mix64(s[kSeed], frame.index);
    candidates_count_ = s[kVpls];
    if (s[kViewVpls]) {
        candidates_count_ = candidates_for(s[kVpls]);
        if (inputs.small_steps) candidates_count_ = std::max(s[kVpls], candidates_count_ / kFewerCandidates);
    }
    return timed(frame, "VPL seeding", [&] {
        return light_seeding_.seed(frame, light_views_of(frame, inputs), inputs.light_gbuffers,
                                   inputs.materials, candidates_count_, seed,
                                   s[kViewVpls] ? candidates_ : work.target.bounces[0].seeds);
    });
}

/// Chooses the VPLs of the first bounce among the candidates, if there are any.
Result<void> LightingMaker::choose_seeds(Frame& frame, Seeds& target) {
    const EngineSettings& s = frame.settings;
    if (!s[kViewVpls]) return {};
    LUCARNE_TRY(timed(frame, "VPL importance", [&] {
        return view_importance_.measure(frame.gl.device, candidates_, candidates_count_);
    }));
    target.host_lights = draw_candidates(candidates_.host_lights, view_importance_.importance(),
                                         view_importance_.nearness(), s[kVpls], mix64(s[kSeed], frame.index));
    LUCARNE_TRY(frame.gl.device.reserve(target.lights, s[kVpls] * sizeof(VplLight), "virtual point lights"));
    target.lights.upload_all(target.host_lights);
    return {};
}

uint32_t LightingMaker::end_of_step(const Inputs& inputs, uint32_t maps) const {
    return inputs.small_steps ? std::min(maps_done_ + kMapsOfStep, maps) : maps;
}

/// Notes that the maps before `end` are done.
StepResult LightingMaker::maps_result(uint32_t end, uint32_t maps) {
    maps_done_ = end == maps ? 0 : end;
    return end == maps ? StepResult::done : StepResult::again;
}

/// Draws the shadow maps of the bounce, or the next of them.
Result<StepResult> LightingMaker::draw_maps(Work& work, uint32_t bounce) {
    Device& device = work.frame.gl.device;
    const DeviceCut& cut = *work.frame.gl.cuts.light;
    const AtlasLayout& layout = work.target.layout;
    const uint32_t end = end_of_step(work.inputs, layout.maps);
    const auto drawn = with_atlas(work.target, bounce, [&]() -> Result<void> {
        if (maps_done_ == 0) LUCARNE_TRY(clear_shadow_maps(device, cut, layout, bounce < last_, maps_));
        return splat_shadow_maps(device, cut, work.target.bounces[bounce - 1].seeds, maps_done_, end,
                                 work.frame.times, maps_);
    });
    LUCARNE_TRY(drawn);
    return maps_result(end, layout.maps);
}

Result<void> LightingMaker::close_maps(Frame& frame, Seeds& seeds) {
    LUCARNE_TRY(close_shadow_maps(frame.gl.device, frame.times, maps_));
    // Each averaged frame blurs less, so that the average converges.
    const float shrink = 1.0f / static_cast<float>(frame.index + 1);
    return timed(frame, "VPL footprints",
                 [&] { return trim_footprints(frame.gl.device, maps_, shrink, seeds); });
}

/// Finds places for the VPLs of the next bounce, or for some of them.
Result<StepResult> LightingMaker::race(Work& work, uint32_t bounce) {
    Frame& frame = work.frame;
    redistribution_.best_candidate = frame.settings[kBestCandidate];
    redistribution_.footprint_variance = footprint_variance(frame.index);
    const auto salt = static_cast<uint32_t>(mix64(mix64(frame.settings[kSeed], frame.index), bounce));
    const uint32_t maps = work.target.layout.maps, end = end_of_step(work.inputs, maps);
    const TimedPass pass(frame, "VPL redistribution");
    LUCARNE_TRY(with_atlas(work.target, bounce, [&] {
        return race_maps(frame.gl.device, *frame.gl.cuts.light, maps_, work.inputs.materials, glossy(frame),
                         salt, work.target.bounces[bounce - 1].seeds, maps_done_, end, redistribution_,
                         work.target.bounces[bounce].seeds);
    }));
    return maps_result(end, maps);
}

/// Places the VPLs of the next bounce.
Result<void> LightingMaker::combine(Work& work, uint32_t bounce) {
    Frame& frame = work.frame;
    const TimedPass pass(frame, "VPL redistribution");
    return with_atlas(work.target, bounce, [&] {
        return combine_races(frame.gl.device, *frame.gl.cuts.light, maps_, work.inputs.materials,
                             glossy(frame), work.target.bounces[bounce - 1].seeds, redistribution_,
                             work.target.bounces[bounce].seeds);
    });
}

}  // namespace lucarne::gi::vpl
