#include "gi/engines/vpl/lighting_maker.h"

#include <algorithm>
#include <utility>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/footprints.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/engines/vpl/options.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
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
    bounce_ = 1;
    made_ = maps_done_ = 0;
    drawn_views_ = 0;
    next_ = Step::casters;
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

Result<void> LightingMaker::step(Frame& frame, const Inputs& inputs, Lighting& target) {
    made_ = 0;
    switch (next_) {
        case Step::none:
            return {};
        case Step::casters: {
            LUCARNE_ASSIGN(target.layout, atlas_layout(frame.settings[kAtlas], frame.settings[kVpls]));
            target.basis.index = UINT64_MAX;
            target.is_united = false;
            target.bounces.resize(last_);
            const bool known = looked_ == without_lights(basis_);
            next_ = known ? Step::light_views : Step::importons;
            if (known) return step(frame, inputs, target);
            looked_.index = UINT64_MAX;
            return decode(frame);
        }
        case Step::importons:
            if (frame.settings[kViewVpls]) basis_.camera = frame.camera;
            next_ = Step::further_importons;
            return place_importons(frame, inputs);
        case Step::further_importons:
            next_ = Step::light_views;
            LUCARNE_TRY(place_further_importons(frame, inputs));
            looked_ = without_lights(basis_);
            return {};
        case Step::light_views: {
            // As many as there are: one that a moving light has may be missing in every frame.
            const std::vector<LightView> views = light_views_of(frame, inputs);
            if (inputs.small_steps && drawn_views_ < views.size()) {
                const TimedPass pass(frame, "light G-buffer");
                LUCARNE_ASSIGN(const bool drawn, inputs.light_gbuffers.draw_missing(frame.gl.device, views));
                ++drawn_views_;
                if (drawn) return {};
            }
            next_ = Step::seeds;
            return step(frame, inputs, target);
        }
        case Step::seeds:
            basis_.scene.lights = inputs.now.scene.lights;
            basis_.cuts.light_views = inputs.now.cuts.light_views;
            next_ = Step::importance;
            return seed(frame, inputs, target.bounces[0].seeds);
        case Step::importance:
            next_ = Step::maps;
            return choose_seeds(frame, target.bounces[0].seeds);
        case Step::maps:
        case Step::closing:
        case Step::races:
        case Step::combination:
            break;
    }
    Buffer& atlas = target.bounces[keeps_bounces(target.layout, last_) ? bounce_ - 1 : 0].atlas;
    std::swap(maps_.atlas, atlas);
    const auto done = step_of_bounce(frame, inputs, target);
    std::swap(maps_.atlas, atlas);
    LUCARNE_TRY(done);
    if (!running()) target.basis = basis_;
    return {};
}

Result<void> LightingMaker::step_of_bounce(Frame& frame, const Inputs& inputs, Lighting& target) {
    if (next_ == Step::maps) {
        LUCARNE_TRY(draw_maps(frame, inputs, target));
        if (maps_done_ == target.layout.maps) next_ = Step::closing;
    } else if (next_ == Step::closing) {
        LUCARNE_TRY(close_maps(frame, target));
        made_ = bounce_;
        maps_done_ = 0;
        next_ = bounce_ < last_ ? Step::races : Step::none;
    } else if (next_ == Step::races) {
        LUCARNE_TRY(race(frame, inputs, target));
        if (maps_done_ == target.layout.maps) next_ = Step::combination;
    } else {
        LUCARNE_TRY(combine(frame, inputs, target));
        ++bounce_;
        maps_done_ = 0;
        next_ = Step::maps;
    }
    return {};
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
    if (!frame.settings[kViewVpls]) return {};
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    LUCARNE_TRY(view_importance_.look_further(frame, inputs.materials, seed, maps_));
    if (sky_.dark()) return {};
    LUCARNE_ASSIGN(const auto openings, view_importance_.openings(frame.gl.device));
    sky_.favour(openings);
    return {};
}

std::vector<LightView> LightingMaker::light_views_of(const Frame& frame, const Inputs& inputs) const {
    Frame sampled = frame;
    sampled.index = inputs.light_index;
    return light_views(sampled, sky_);
}

/// Places the VPLs of the first bounce, or candidates for them.
Result<void> LightingMaker::seed(Frame& frame, const Inputs& inputs, Seeds& target) {
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
                                   s[kViewVpls] ? candidates_ : target);
    });
}

/// Chooses the VPLs of the first bounce among the candidates, if there are any.
Result<void> LightingMaker::choose_seeds(Frame& frame, Seeds& target) {
    const EngineSettings& s = frame.settings;
    if (!s[kViewVpls]) return {};
    LUCARNE_TRY(timed(frame, "VPL importance", [&] {
        return view_importance_.measure(frame.gl.device, candidates_, candidates_count_);
    }));
    target.host_lights = draw_candidates(candidates_.host_lights, view_importance_.importance(), s[kVpls],
                                         mix64(s[kSeed], frame.index));
    LUCARNE_TRY(frame.gl.device.reserve(target.lights, s[kVpls] * sizeof(VplLight), "virtual point lights"));
    target.lights.upload_all(target.host_lights);
    return {};
}

uint32_t LightingMaker::end_of_step(const Inputs& inputs, uint32_t maps) const {
    return inputs.small_steps ? std::min(maps_done_ + kMapsOfStep, maps) : maps;
}

/// Draws the shadow maps of the bounce, or the next of them.
Result<void> LightingMaker::draw_maps(Frame& frame, const Inputs& inputs, Lighting& target) {
    Device& device = frame.gl.device;
    const DeviceCut& cut = *frame.gl.cuts.light;
    if (maps_done_ == 0) LUCARNE_TRY(clear_shadow_maps(device, cut, target.layout, needs_sources(), maps_));
    const uint32_t end = end_of_step(inputs, target.layout.maps);
    LUCARNE_TRY(splat_shadow_maps(device, cut, target.bounces[bounce_ - 1].seeds, maps_done_, end,
                                  frame.times, maps_));
    maps_done_ = end;
    return {};
}

Result<void> LightingMaker::close_maps(Frame& frame, Lighting& target) {
    LUCARNE_TRY(close_shadow_maps(frame.gl.device, frame.times, maps_));
    // Each averaged frame blurs less, so that the average converges.
    const float shrink = 1.0f / static_cast<float>(frame.index + 1);
    return timed(frame, "VPL footprints", [&] {
        return trim_footprints(frame.gl.device, maps_, shrink, target.bounces[bounce_ - 1].seeds);
    });
}

/// Finds places for the VPLs of the next bounce, or for some of them.
Result<void> LightingMaker::race(Frame& frame, const Inputs& inputs, Lighting& target) {
    redistribution_.best_candidate = frame.settings[kBestCandidate];
    redistribution_.footprint_variance = footprint_variance(frame.index);
    const auto salt = static_cast<uint32_t>(mix64(mix64(frame.settings[kSeed], frame.index), bounce_));
    const uint32_t end = end_of_step(inputs, target.layout.maps);
    const TimedPass pass(frame, "VPL redistribution");
    LUCARNE_TRY(race_maps(frame.gl.device, *frame.gl.cuts.light, maps_, inputs.materials, glossy(frame), salt,
                          target.bounces[bounce_ - 1].seeds, maps_done_, end, redistribution_,
                          target.bounces[bounce_].seeds));
    maps_done_ = end;
    return {};
}

/// Places the VPLs of the next bounce.
Result<void> LightingMaker::combine(Frame& frame, const Inputs& inputs, Lighting& target) {
    return timed(frame, "VPL redistribution", [&] {
        return combine_races(frame.gl.device, *frame.gl.cuts.light, maps_, inputs.materials, glossy(frame),
                             target.bounces[bounce_ - 1].seeds, redistribution_,
                             target.bounces[bounce_].seeds);
    });
}

}  // namespace lucarne::gi::vpl
