#include "gi/engines/vpl/vpl.h"

#include <bit>
#include <utility>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/lighting_maker.h"
#include "gi/engines/vpl/options.h"
#include "gi/engines/vpl/shading/shading.h"
#include "gi/engines/vpl/sky/sky_light.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"

namespace lucarne::gi {
namespace vpl {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info,      &kOnlyBounce.info,    &kVpls.info,
                                          &kInterleave.info,   &kAtlas.info,         &kLightResolution.info,
                                          &kLightSamples.info, &kSkyDirections.info, &kBestCandidate.info,
                                          &kViewVpls.info,     &kReuse.info,         &kSeed.info};
constexpr EngineInfo kInfo{.name = "vpl",
                           .label = "Global illumination",
                           .description = "virtual point lights with imperfect shadow maps",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true}};

class VplEngine : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;
    bool reads_light_cuts() const override { return making_.running(); }

 protected:
    void update(const Changes& changes) override;
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    Result<void> render_at_once(Frame& frame);
    Result<void> render_in_motion(Frame& frame);
    Result<void> make_and_shade(Frame& frame, const Basis& basis);
    Result<void> take_steps(Frame& frame, const Basis& basis);
    Result<void> shade_in_motion(Frame& frame, const Basis& basis);
    Result<void> shade_ambient(Frame& frame);
    Result<void> shade(Frame& frame, const Bounce& bounce, const AtlasLayout& layout, const Buffer& atlas);
    Result<void> merge(Frame& frame);
    Result<void> add_views(Frame& frame, const std::vector<LightView>& views, bool of_sky, bool any_state);
    Result<void> add_direct(Frame& frame, bool any_state);
    LightingMaker::Inputs inputs(const Basis& now);
    Basis basis_of(const Frame& frame) const;

    Buffer materials_;
    Sky sky_;
    SkyLight sky_light_;
    bool tiles_have_sky_ = false;  ///< the direct light of the sky is in the tiles of the frame
    SkyDirections light_sky_;      ///< the directions of the sky from which light is sampled
    uint64_t light_index_ = 0;     ///< Frame::index by which lights with a size are sampled
    std::vector<LightView> views_;
    LightGBuffers light_gbuffers_;
    LightingMaker making_;
    /// The light of the first frame of an average, which a moving camera sees as well; and the light of the
    /// average's other frames, or that which is being made while the camera moves.
    Lighting lasting_, other_;
    AtlasLayout layout_;    ///< of the last frame
    float ambient_ = 0;     ///< W/m^2, until there is any light to show in motion
    SceneRevisions scene_;  ///< of the frame that is drawn
    LightCutRevisions cuts_;
    Tiles tiles_;
    History history_;
    bool indirect_ = false;  ///< the last frame had indirect light
};

Result<void> VplEngine::prepare(Frame& frame) {
    const EngineSettings& s = frame.settings;
    if (s[kInterleave] != 1 && s[kInterleave] != 2 && s[kInterleave] != 4)
        return bad_arguments("vpl", fmt::format("it cannot interleave {0} x {0} pixels", s[kInterleave]),
                             "choose 1, 2 or 4");
    LUCARNE_ASSIGN(layout_, atlas_layout(s[kAtlas], s[kVpls]));
    if (frame.gl.cuts.light_views.size() < frame.lights.size())
        return failed("vpl", "there are fewer light views than lights");
    LUCARNE_TRY(upload_sky(frame, sky_));
    sky_light_.set_environment(frame.environment);
    if (light_sky_.environment() != sky_.directions.environment()) light_sky_ = sky_.directions;
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

void VplEngine::update(const Changes& changes) {
    scene_ = changes.scene;
    cuts_ = changes.light_cuts;
}

/// Returns what the VPLs of a frame are made from. A moving camera keeps the VPLs that were chosen for a view
/// close to its own: new ones in every frame would flicker.
Basis VplEngine::basis_of(const Frame& frame) const {
    Basis basis{scene_, frame.settings, cuts_, frame.index, {}};
    basis.scene.settings = 0;
    basis.settings.set(kInterleave, 1);
    basis.settings.set(kReuse, true);
    basis.settings.set(kSkyDirections, kSkyCounts.front());
    if (!frame.settings[kViewVpls]) return basis;
    const bool serves = frame.moving && making_.serves(frame.camera);
    basis.camera = serves ? making_.looked_from() : frame.camera;
    return basis;
}

LightingMaker::Inputs VplEngine::inputs(const Basis& now) {
    return {.now = now,
            .materials = materials_,
            .sky = sky_.directions,
            .light_gbuffers = light_gbuffers_,
            .light_index = light_index_};
}

/// Adds the light of the VPLs of one bounce.
Result<void> VplEngine::shade(Frame& frame, const Bounce& bounce, const AtlasLayout& layout,
                              const Buffer& atlas) {
    return timed(frame, "VPL shading",
                 [&] { return shade_tiles(frame, materials_, bounce.seeds, layout, atlas, tiles_); });
}

Result<void> VplEngine::merge(Frame& frame) {
    const bool reuse = frame.moving && frame.settings[kReuse];
    if (reuse) LUCARNE_TRY(history_.begin(frame, scene_));
    return timed(frame, "VPL merge",
                 [&] { return merge_tiles(frame, materials_, tiles_, reuse ? &history_ : nullptr); });
}

/// Adds the light of the requested bounces to the tiles. VPLs and maps are kept while nothing but the
/// camera moves.
Result<void> VplEngine::make_and_shade(Frame& frame, const Basis& basis) {
    const EngineSettings& s = frame.settings;
    const uint32_t last = last_bounce(s);
    const bool keep = keeps_bounces(layout_, last);
    const auto shade_bounce = [&](const Lighting& lighting, uint32_t bounce) -> Result<void> {
        if (s[kOnlyBounce] >= 0 && bounce < last) return {};
        return shade(frame, lighting.bounces[bounce - 1], lighting.layout,
                     lighting.bounces[keep ? bounce - 1 : 0].atlas);
    };
    const bool first = keep && frame.index == 0;
    if (!keep || !((first ? lasting_ : other_).basis == basis)) {
        making_.begin(basis);
        LightingMaker::Inputs in = inputs(basis);
        if (!keep) in.made = [&](uint32_t bounce) { return shade_bounce(other_, bounce); };
        LUCARNE_TRY(making_.run(frame, in, {}, other_));
        if (making_.running()) {  // the frame was given up; frames in motion make light elsewhere
            making_.stop();
            return {};
        }
        if (first) std::swap(lasting_, other_);
    }
    for (uint32_t bounce = 1; keep && bounce <= last; ++bounce)
        LUCARNE_TRY(shade_bounce(first ? lasting_ : other_, bounce));
    return {};
}

/// Continues to make light, for the time that the frame allows.
Result<void> VplEngine::take_steps(Frame& frame, const Basis& basis) {
    if (!making_.goes_on(basis)) making_.begin(basis);
    LightingMaker::Inputs in = inputs(basis);
    in.small_steps = true;
    LUCARNE_TRY(making_.run(frame, in, frame.light_budget, other_));
    if (making_.running()) return {};
    std::swap(lasting_, other_);
    light_sky_ = making_.sky();
    return {};
}

/// Shades with the last light that was made. On a processor, VPLs of all bounces share the time of one.
Result<void> VplEngine::shade_in_motion(Frame& frame, const Basis& basis) {
    if (!lasting_.serves(basis)) return shade_ambient(frame);
    LUCARNE_TRY(timed(frame, "VPL join", [&] { return join_tiles(frame, glossy(frame), tiles_); }));
    const uint32_t last = last_bounce(frame.settings);
    if (frame.settings[kOnlyBounce] < 0 && last > 1 && frame.gl.device.info().software) {
        if (!lasting_.is_united)
            LUCARNE_TRY(timed(frame, "VPL union", [&] { return unite_bounces(frame.gl.device, lasting_); }));
        LUCARNE_TRY(shade(frame, lasting_.united, lasting_.layout, lasting_.united.atlas));
    } else {
        for (uint32_t bounce = frame.settings[kOnlyBounce] < 0 ? 1 : last; bounce <= last; ++bounce)
            LUCARNE_TRY(shade(frame, lasting_.bounces[bounce - 1], lasting_.layout,
                              lasting_.bounces[bounce - 1].atlas));
    }
    return merge(frame);
}

/// Lights the picture evenly. The VPLs that come later replace this light as quickly as History forgets it.
Result<void> VplEngine::shade_ambient(Frame& frame) {
    if (other_.layout.maps && !other_.bounces.empty())
        ambient_ = ambient_irradiance(other_.bounces[0].seeds, frame.bounds, frame.settings[kBounces]);
    Frame plain = frame;
    plain.settings.set(kInterleave, 1);  // so that each pixel is lit by itself
    LUCARNE_TRY(timed(plain, "VPL join", [&] { return join_tiles(plain, glossy(plain), tiles_); }));
    tiles_.diffuse.clear(std::bit_cast<uint32_t>(ambient_));
    return merge(plain);
}

/// Adds the first reflection of the lights of some views, of those of the sky only or of all others.
Result<void> VplEngine::add_views(Frame& frame, const std::vector<LightView>& views, bool of_sky,
                                  bool any_state) {
    Device& device = frame.gl.device;
    for (const LightView& view : views) {
        if (view.of_sky != of_sky) continue;
        LUCARNE_ASSIGN(const GBuffer* seen, any_state ? light_gbuffers_.look_at_any_state(device, view)
                                                      : light_gbuffers_.look(device, view));
        LUCARNE_TRY(add_light(frame, materials_, view, *seen));
    }
    return {};
}

/// Adds emission, background and the first reflection of the lights. `any_state`: shadows may be those of a
/// moment ago.
Result<void> VplEngine::add_direct(Frame& frame, bool any_state) {
    const TimedPass pass(frame, "direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, true));
    LUCARNE_TRY(add_views(frame, views_, false, any_state));
    if (!tiles_have_sky_) return add_views(frame, views_, true, any_state);
    if (sky_light_.bright().dark()) return {};
    return add_views(frame, light_views(frame, sky_light_.bright(), light_index_), true, any_state);
}

/// Makes all light that the frame needs.
Result<void> VplEngine::render_at_once(Frame& frame) {
    const EngineSettings& s = frame.settings;
    making_.stop();
    light_index_ = frame.index;
    const Basis basis = basis_of(frame);
    const bool lit = !frame.lights.empty() || !sky_.directions.dark() || emits(frame);
    // The sky's direct light needs casters, and its directions are favoured if VPLs are.
    if (lit && (wants_indirect(s) || !sky_.directions.dark())) {
        LUCARNE_TRY(making_.look(frame, inputs(basis), basis));
        light_sky_ = making_.sky();
    }
    views_ = light_views(frame, light_sky_, light_index_);
    light_gbuffers_.begin(frame.gl.device, views_, views_.size());
    if (!views_.empty())
        LUCARNE_TRY(
            timed(frame, "light G-buffer", [&] { return light_gbuffers_.look(frame.gl.device, views_[0]); }));
    indirect_ = wants_indirect(s) && (!views_.empty() || emits(frame));
    tiles_have_sky_ = wants_direct(s) && !sky_light_.dark();
    if (indirect_ || tiles_have_sky_) {
        LUCARNE_TRY(timed(frame, "VPL join", [&] { return join_tiles(frame, glossy(frame), tiles_); }));
        if (indirect_) LUCARNE_TRY(make_and_shade(frame, basis));
        if (frame.stopped()) return {};
        if (tiles_have_sky_)
            LUCARNE_TRY(sky_light_.add(frame, materials_, making_.openings(), making_.casters(), tiles_));
        LUCARNE_TRY(merge(frame));
    } else {
        frame.gl.radiance.clear(0);
    }
    if (frame.stopped()) return {};
    return wants_direct(s) ? add_direct(frame, false) : Result<void>{};
}

/// Shows light of earlier frames where that of this one takes long, and makes new light meanwhile.
Result<void> VplEngine::render_in_motion(Frame& frame) {
    tiles_have_sky_ = false;
    views_ = light_views(frame, light_sky_, light_index_);
    light_gbuffers_.begin(frame.gl.device, views_, 2 * views_.size());
    indirect_ = wants_indirect(frame.settings) && (!views_.empty() || emits(frame));
    if (indirect_) {
        const Basis basis = basis_of(frame);
        if (lasting_.basis == basis)
            making_.stop();
        else
            LUCARNE_TRY(take_steps(frame, basis));
        LUCARNE_TRY(shade_in_motion(frame, basis));
    } else {
        frame.gl.radiance.clear(0);
        LUCARNE_TRY(light_gbuffers_.renew(frame, views_));
    }
    return wants_direct(frame.settings) ? add_direct(frame, true) : Result<void>{};
}

Result<void> VplEngine::render(Frame& frame) {
    const bool in_parts =
        frame.moving && !frame.light_budget.whole() && keeps_bounces(layout_, last_bounce(frame.settings));
    return in_parts ? render_in_motion(frame) : render_at_once(frame);
}

std::vector<std::pair<std::string, double>> VplEngine::stats() const {
    if (!indirect_) return {{"vpls", 0}};
    return {{"vpls", layout_.maps}, {"ism_side", layout_.side}};
}

}  // namespace
}  // namespace vpl

EngineEntry vpl_engine() {
    return {vpl::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<vpl::VplEngine>(); }};
}

}  // namespace lucarne::gi
