#include "gi/engines/vpl/vpl.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/footprints.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/engines/vpl/options.h"
#include "gi/engines/vpl/redistribution/redistribution.h"
#include "gi/engines/vpl/seeding/light_gbuffers.h"
#include "gi/engines/vpl/shading/shading.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/engines/vpl/view_importance/view_importance.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace vpl {
namespace {

/// Everything from which VPLs and maps are made.
struct Basis {
    SceneRevisions scene;
    LightCutRevisions cuts;
    uint64_t index = UINT64_MAX;  ///< of the frame
    CameraView camera{};          ///< for which VPLs were chosen, if they are chosen by the view
    bool operator==(const Basis&) const = default;
};

/// The VPLs of one bounce and their maps.
struct Bounce {
    Seeds seeds;
    Buffer atlas;
};

// Bytes of maps that are kept from frame to frame: sixteen bounces of `interactive`, one of `high`.
constexpr size_t kMostKept = size_t{64} << 20;

constexpr const OptionInfo* kOptions[] = {&kBounces.info,      &kOnlyBounce.info,    &kVpls.info,
                                          &kInterleave.info,   &kAtlas.info,         &kLightResolution.info,
                                          &kLightSamples.info, &kBestCandidate.info, &kViewVpls.info,
                                          &kReuse.info,        &kSeed.info};
constexpr EngineInfo kInfo{
    .name = "vpl", .description = "virtual point lights with imperfect shadow maps", .options = kOptions};

class VplEngine : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;

 protected:
    void update(const Changes& changes) override;
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    Result<void> add_direct(Frame& frame);
    Result<void> look_around(Frame& frame, const Basis& basis);
    Result<void> light_indirectly(Frame& frame, const Basis& basis);
    Result<void> seed(Frame& frame, Seeds& target);
    Basis basis_of(const Frame& frame) const;

    Buffer materials_;
    Sky sky_;
    LightGBuffers light_gbuffers_;
    Seeds candidates_;
    ViewImportance view_importance_;
    std::vector<Bounce> bounces_;
    ShadowMaps maps_;       ///< borrows the atlas of a bounce while it is drawn or read
    Basis basis_;           ///< what bounces_ were made from
    Basis looked_;          ///< for which the casters were decoded and the importance was measured
    SceneRevisions scene_;  ///< of the frame that is drawn
    LightCutRevisions cuts_;
    Tiles tiles_;
    History history_;
    Redistribution redistribution_;
    bool indirect_ = false;  ///< the last frame had indirect light
};

bool wants_direct(const EngineSettings& s) {
    return s[kOnlyBounce] <= 0;
}
bool wants_indirect(const EngineSettings& s) {
    return s[kOnlyBounce] < 0 ? s[kBounces] > 0 : s[kOnlyBounce] > 0;
}

bool glossy(const Frame& frame) {
    return std::any_of(frame.materials.begin(), frame.materials.end(),
                       [](const Material& m) { return m.diffuse.w > 0; });
}

template <class Body>
Result<void> pass(Frame& frame, const char* name, const Body& body) {
    const TimedPass timed(frame, name);
    return body();
}

Result<void> VplEngine::prepare(Frame& frame) {
    const EngineSettings& s = frame.settings;
    if (s[kInterleave] != 1 && s[kInterleave] != 2 && s[kInterleave] != 4)
        return bad_arguments("vpl", fmt::format("it cannot interleave {0} x {0} pixels", s[kInterleave]),
                             "choose 1, 2 or 4");
    LUCARNE_TRY(atlas_layout(s[kAtlas], s[kVpls]));
    if (frame.gl.cuts.light_views.size() < frame.lights.size())
        return failed("vpl", "there are fewer light views than lights");
    LUCARNE_TRY(upload_sky(frame, sky_));
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

void VplEngine::update(const Changes& changes) {
    scene_ = changes.scene;
    cuts_ = changes.light_cuts;
}

/// Returns what the VPLs of a frame are made from. A moving camera keeps the VPLs that were chosen for a view
/// close to its own: new ones in every frame would flicker.
Basis VplEngine::basis_of(const Frame& frame) const {
    Basis basis{scene_, cuts_, frame.index, {}};
    if (!frame.settings[kViewVpls]) return basis;
    const bool serves = frame.moving && view_importance_.serves(frame.camera);
    basis.camera = serves ? looked_.camera : frame.camera;
    return basis;
}

/// Places the VPLs of the first bounce. The casters must have been decoded.
Result<void> VplEngine::seed(Frame& frame, Seeds& target) {
    const EngineSettings& s = frame.settings;
    const uint64_t seed = mix64(s[kSeed], frame.index);
    const uint32_t count = s[kViewVpls] ? candidates_for(s[kVpls]) : s[kVpls];
    Seeds& placed = s[kViewVpls] ? candidates_ : target;
    LUCARNE_TRY(pass(frame, "VPL seeding",
                     [&] { return light_gbuffers_.seed(frame, materials_, count, seed, placed); }));
    if (!s[kViewVpls]) return {};
    LUCARNE_TRY(pass(frame, "VPL importance",
                     [&] { return view_importance_.measure(frame.gl.device, candidates_, count); }));
    target.host_lights =
        draw_candidates(candidates_.host_lights, view_importance_.importance(), s[kVpls], seed);
    LUCARNE_TRY(frame.gl.device.reserve(target.lights, s[kVpls] * sizeof(VplLight), "virtual point lights"));
    target.lights.upload_all(target.host_lights);
    return {};
}

/// Decodes the casters and measures what matters to the camera.
Result<void> VplEngine::look_around(Frame& frame, const Basis& basis) {
    if (looked_ == basis) return {};
    looked_.index = UINT64_MAX;  // invalid until everything is done
    LUCARNE_TRY(pass(frame, "ISM casters",
                     [&] { return decode_casters(frame.gl.device, *frame.gl.cuts.light, maps_); }));
    sky_.directions.favour({});
    if (frame.settings[kViewVpls]) {
        const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
        LUCARNE_TRY(view_importance_.look(frame, materials_, seed, maps_));
        if (!sky_.directions.dark()) {
            LUCARNE_ASSIGN(const auto openings, view_importance_.openings(frame.gl.device));
            sky_.directions.favour(openings);
        }
    }
    looked_ = basis;
    return {};
}

/// Sets frame.gl.radiance to the light of the requested bounces. It places VPLs on the surfaces that the
/// lights see, draws their shadow maps and shades interleaved pixels, then redistributes the VPLs and repeats
/// this for the next bounce. VPLs and maps are kept while nothing but the camera moves.
Result<void> VplEngine::light_indirectly(Frame& frame, const Basis& basis) {
    const EngineSettings& s = frame.settings;
    const uint32_t last = s[kOnlyBounce] < 0 ? s[kBounces] : static_cast<uint32_t>(s[kOnlyBounce]);
    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(s[kAtlas], s[kVpls]));
    const bool keep = layout.texels() * sizeof(uint32_t) * last <= kMostKept;
    const bool held = keep && basis == basis_;
    basis_.index = UINT64_MAX;  // invalid until everything is drawn
    // Each averaged frame blurs less, so that the average converges.
    const float shrink = 1.0f / static_cast<float>(frame.index + 1);
    bounces_.resize(std::max<size_t>(bounces_.size(), last));
    redistribution_.best_candidate = s[kBestCandidate];
    redistribution_.footprint_variance = footprint_variance(frame.index);
    LUCARNE_TRY(pass(frame, "VPL join", [&] { return join_tiles(frame, glossy(frame), tiles_); }));
    if (!held) LUCARNE_TRY(seed(frame, bounces_[0].seeds));
    for (uint32_t bounce = 1; bounce <= last; ++bounce) {
        Seeds& seeds = bounces_[bounce - 1].seeds;
        Buffer& atlas = bounces_[keep ? bounce - 1 : 0].atlas;
        std::swap(maps_.atlas, atlas);
        Result<void> done = held ? Result<void>{}
                                 : draw_shadow_maps(frame.gl.device, *frame.gl.cuts.light, seeds, layout,
                                                    bounce < last, frame.times, maps_);
        if (done && !held)
            done = pass(frame, "VPL footprints",
                        [&] { return trim_footprints(frame.gl.device, maps_, shrink, seeds); });
        if (done && (s[kOnlyBounce] < 0 || bounce == last))
            done = pass(frame, "VPL shading",
                        [&] { return shade_tiles(frame, materials_, seeds, maps_, tiles_); });
        if (done && !held && bounce < last)
            done = pass(frame, "VPL redistribution", [&] {
                const auto salt = static_cast<uint32_t>(mix64(mix64(s[kSeed], frame.index), bounce));
                return redistribute(frame.gl.device, *frame.gl.cuts.light, maps_, materials_, glossy(frame),
                                    salt, seeds, redistribution_, bounces_[bounce].seeds);
            });
        std::swap(maps_.atlas, atlas);
        LUCARNE_TRY(done);
    }
    basis_ = basis;
    const bool reuse = frame.moving && s[kReuse];
    if (reuse) LUCARNE_TRY(history_.begin(frame, scene_));
    return pass(frame, "VPL merge",
                [&] { return merge_tiles(frame, materials_, tiles_, reuse ? &history_ : nullptr); });
}

/// Adds emission, background and the first reflection of the lights.
Result<void> VplEngine::add_direct(Frame& frame) {
    frame.times.begin("direct light");
    LUCARNE_TRY(add_own_light(frame, materials_, sky_, true));
    for (size_t i = 0; i < light_gbuffers_.views().size(); ++i) {
        LUCARNE_ASSIGN(const GBuffer* seen, light_gbuffers_.look(frame, i));
        LUCARNE_TRY(add_light(frame, materials_, light_gbuffers_.views()[i], *seen));
    }
    frame.times.end();
    return {};
}

Result<void> VplEngine::render(Frame& frame) {
    const Basis basis = basis_of(frame);
    const bool lit = !frame.lights.empty() || !sky_.directions.dark() || emits(frame);
    const bool favours = frame.settings[kViewVpls] && !sky_.directions.dark();
    if (lit && (wants_indirect(frame.settings) || favours)) LUCARNE_TRY(look_around(frame, basis));
    light_gbuffers_.begin(frame, sky_.directions);
    frame.times.begin("light G-buffer");
    if (!light_gbuffers_.views().empty()) LUCARNE_TRY(light_gbuffers_.look(frame, 0));
    frame.times.end();
    indirect_ = wants_indirect(frame.settings) && (!light_gbuffers_.views().empty() || emits(frame));
    if (indirect_)
        LUCARNE_TRY(light_indirectly(frame, basis));
    else
        frame.gl.radiance.clear(0);
    return wants_direct(frame.settings) ? add_direct(frame) : Result<void>{};
}

std::vector<std::pair<std::string, double>> VplEngine::stats() const {
    if (!indirect_) return {{"vpls", 0}};
    return {{"vpls", maps_.layout.maps}, {"ism_side", maps_.layout.side}};
}

}  // namespace
}  // namespace vpl

EngineEntry vpl_engine() {
    return {vpl::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<vpl::VplEngine>(); }};
}

}  // namespace lucarne::gi
