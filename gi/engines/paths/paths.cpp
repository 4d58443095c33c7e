#include "gi/engines/paths/paths.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "gi/bounce_options.h"
#include "gi/changes.h"
#include "gi/engines/paths/arriving_light.h"
#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/entry_light.h"
#include "gi/engines/paths/interpolation.h"
#include "gi/engines/paths/native/grid_light.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/paths/pixel_points.h"
#include "gi/engines/paths/relight.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/gather_sky.h"
#include "gi/gather/upsample.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/lighting/light_options.h"
#include "gi/native/reflectance.h"
#include "gi/shared/brdf.h"

namespace lucarne::gi {
namespace paths {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info,      &kOnlyBounce.info,  &kPointSpacing.info,
                                          &kGatherRays.info,   &kEntryPoints.info, &kTransport.info,
                                          &kSkyLight.info,     &kGatherEvery.info, &kLightResolution.info,
                                          &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "paths",
                           .label = "Light paths in advance",
                           .description = "light paths computed in advance: lamps move with all bounces",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true},
                           .precomputes = &kPathsPrecomputes};

class PathsEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;

 protected:
    void update(const Changes& changes) override {
        scene_ = changes.scene;
        cuts_ = changes.light_cuts;
    }
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    /// What the light at the gathering points depends on, beside the bake.
    struct Basis {
        SceneRevisions scene;
        LightCutRevisions cuts;
        std::vector<Light> lights;  ///< of the views
        bool operator==(const Basis&) const = default;
    };
    Result<void> relight(Frame& frame, const std::vector<LightView>& views, bool any_state);
    const ArrivingLight* arriving_light(Frame& frame, std::span<const Material> materials);
    void add_by_grid(const Frame& frame, std::span<const Material> materials,
                     std::span<const GBufferTexel> texels, uint32_t step, std::span<glm::vec4> radiance);
    void add_indirect(Frame& frame);

    SceneRevisions scene_;
    LightCutRevisions cuts_;
    Buffer materials_;
    Sky sky_;
    GatherSky even_sky_;
    std::optional<uint64_t> even_sky_of_;  ///< revision of the environment that it is made from
    LightGBuffers light_gbuffers_;
    uint64_t light_index_ = 0;  ///< Frame::index by which lights with a size are sampled
    EntryLight entry_light_;
    std::unique_ptr<Relight> relight_;
    Basis light_of_;
    std::vector<glm::vec3> irradiance_;      ///< at gathering points; empty: not known
    std::optional<ArrivingLight> arriving_;  ///< for glossy surfaces
    bool arriving_is_old_ = true;
    PixelPoints pixel_points_;
    size_t alone_ = 0;  ///< pixels of the last frame that no gathering point reached
};

Result<void> PathsEngine::prepare(Frame& frame) {
    if (frame.gl.cuts.light_views.size() < frame.lights.size() || !frame.gl.cuts.light)
        return failed("paths", "the cuts of the light are missing");
    const auto* bake = dynamic_cast<const PathsBake*>(frame.bake);
    if (!bake) {
        relight_.reset();
    } else if (!relight_ || &relight_->bake() != bake) {
        relight_ = std::make_unique<Relight>(bake->shared_from_this());
        irradiance_.clear();
        arriving_.reset();
        pixel_points_ = {};
    }
    LUCARNE_TRY(upload_sky(frame, sky_));
    if (even_sky_of_ != scene_.environment) {
        even_sky_ = gather_sky(frame.environment);
        even_sky_of_ = scene_.environment;
    }
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

/// Brings the light at the gathering points up to date.
Result<void> PathsEngine::relight(Frame& frame, const std::vector<LightView>& views, bool any_state) {
    const EngineSettings& s = frame.settings;
    // What few links would miss needs views.
    const bool by_links = s[kSkyLight] == SkyLight::links && !even_sky_.bright;
    Basis basis{scene_, cuts_, {}};
    std::vector<LightView> entering_views;
    for (const LightView& view : views) {
        if (by_links && view.of_sky) continue;
        entering_views.push_back(view);
        basis.lights.push_back(view.light);
    }
    // In motion nodes arrive all the time, and light of a moment ago will do.
    if (any_state) basis.cuts = light_of_.cuts;
    if (!irradiance_.empty() && light_of_ == basis) return {};
    basis.cuts = cuts_;
    irradiance_.clear();
    std::vector<glm::vec3> entering;
    {
        const TimedPass pass(frame, "entry points");
        LUCARNE_TRY(entry_light_.set_entries(frame, relight_->shared_bake()));
        LUCARNE_ASSIGN(entering, entry_light_.irradiance(frame, entering_views, light_gbuffers_, any_state));
    }
    if (frame.stopped()) return {};
    const bool only = s[kOnlyBounce] >= 0;
    const auto last = only ? static_cast<uint32_t>(s[kOnlyBounce]) : s[kBounces];
    timed(frame, "photon energies", [&] {
        relight_->enter(device_materials(frame.materials), entering, by_links ? &even_sky_ : nullptr);
    });
    timed(frame, "bounces", [&] { relight_->bounce({only ? last : 1, last}, s[kTransport]); });
    irradiance_ =
        timed(frame, "final gathering", [&] { return smooth(relight_->bake(), relight_->gather()); });
    arriving_is_old_ = true;
    light_of_ = std::move(basis);
    return {};
}

/// Returns the light for glossy surfaces; null if no material is glossy.
const ArrivingLight* PathsEngine::arriving_light(Frame& frame, std::span<const Material> materials) {
    if (std::ranges::none_of(materials, [](const Material& m) { return m.diffuse.w > 0; })) return nullptr;
    if (!arriving_) arriving_.emplace(relight_->shared_bake());
    if (std::exchange(arriving_is_old_, false))
        timed(frame, "light by direction", [&] { arriving_->set(relight_->radiosity(), materials); });
    return &*arriving_;
}

/// Finds the light at one pixel in each square of `step`, and adds what all pixels reflect: between these it
/// is interpolated where they lie in one plane.
void PathsEngine::add_by_grid(const Frame& frame, std::span<const Material> materials,
                              std::span<const GBufferTexel> texels, uint32_t step,
                              std::span<glm::vec4> radiance) {
    // The places do not move from frame to frame, or their points would have to be found again.
    const GatherGrid grid{frame.camera.width, frame.camera.height, step, step / 2, step / 2};
    std::vector<uint32_t> pixels;
    for (uint32_t row = 0; row < grid.rows(); ++row)
        for (uint32_t column = 0; column < grid.columns(); ++column)
            pixels.push_back(grid.pixel(column, row));
    const std::vector<SurfacePoint> places = visible_surfaces(frame.camera, texels, pixels);
    std::vector<native::GridLight> lights(pixels.size());
    pixel_points_.visit(PixelPoints::List::grid, places, [&](size_t i, std::span<const PointShare> about) {
        lights[i] = {places[i].position - glm::vec3(frame.camera.origin), 1, places[i].normal,
                     irradiance_of(about, irradiance_)};
    });
    const gi::native::DiffuseTables reflectances(materials);
    const std::vector<uint32_t> rest =
        native::add_grid_light({frame.camera, texels, grid, lights, reflectances, radiance});
    const std::vector<SurfacePoint> others = visible_surfaces(frame.camera, texels, rest);
    pixel_points_.visit(PixelPoints::List::rest, others, [&](size_t i, std::span<const PointShare> about) {
        const Reflectance r =
            make_reflectance(materials[others[i].material % materials.size()], others[i].albedo);
        radiance[rest[i]] += glm::vec4(r.kd / kPi * irradiance_of(about, irradiance_), 0);
    });
}

/// Adds what pixels reflect of the light at the gathering points about them.
void PathsEngine::add_indirect(Frame& frame) {
    const PathsBake& bake = relight_->bake();
    const std::vector<Material> materials = device_materials(frame.materials);
    const ArrivingLight* glossy = arriving_light(frame, materials);
    const TimedPass pass(frame, "interpolation");
    const std::vector<GBufferTexel> texels = download_gbuffer(frame);
    auto radiance = frame.gl.radiance.download_all<glm::vec4>(texels.size());
    // Lobes need the points of each pixel.
    const uint32_t step = glossy ? 1 : frame.settings[kGatherEvery];
    pixel_points_.begin(bake, frame.camera, texels, frame.bake_offset, step);
    if (step > 1) {
        add_by_grid(frame, materials, texels, step, radiance);
    } else {
        const std::vector<SurfacePoint> surfaces = visible_surfaces(frame.camera, texels);
        pixel_points_.visit(
            PixelPoints::List::grid, surfaces, [&](size_t i, std::span<const PointShare> about) {
                if (about.empty()) return;
                const SurfacePoint& at = surfaces[i];
                const glm::vec3 irradiance = irradiance_of(about, irradiance_);
                const Reflectance r = make_reflectance(materials[at.material % materials.size()], at.albedo);
                glm::vec3 reflected = r.kd / kPi * irradiance;
                if (glossy && r.ks > 0)
                    reflected += glossy->reflected(about, irradiance, r, at.normal, at.viewer);
                radiance[i] += glm::vec4(reflected, 0);
            });
    }
    alone_ += pixel_points_.alone();
    upload_radiance(frame, radiance);
}

Result<void> PathsEngine::render(Frame& frame) {
    frame.gl.radiance.clear(0);
    const EngineSettings& s = frame.settings;
    const bool direct = wants_direct(s), indirect = wants_indirect(s) && relight_;
    alone_ = 0;
    if (!direct && !indirect) return {};
    if (direct)
        LUCARNE_TRY(timed(frame, "emission", [&] { return add_own_light(frame, materials_, sky_, false); }));
    // In motion shadows may be those of a moment ago; they are renewed as far as the time goes.
    const bool in_parts = frame.moving && !frame.light_budget.whole();
    if (!in_parts) light_index_ = frame.index;
    const std::vector<LightView> views = light_views(frame, sky_.directions, light_index_);
    Device& device = frame.gl.device;
    light_gbuffers_.begin(device, views, views.size());
    if (in_parts) LUCARNE_TRY(light_gbuffers_.renew(frame, views));
    for (const LightView& from : views) {
        if (!direct) break;
        if (frame.stopped()) return {};
        LUCARNE_ASSIGN(const GBuffer* seen, timed(frame, "light G-buffer", [&] {
                           return in_parts ? light_gbuffers_.look_at_any_state(device, from)
                                           : light_gbuffers_.look(device, from);
                       }));
        LUCARNE_TRY(timed(frame, "direct light", [&] { return add_light(frame, materials_, from, *seen); }));
    }
    if (!indirect) return {};
    LUCARNE_TRY(relight(frame, views, in_parts));
    if (frame.stopped() || irradiance_.empty()) return {};
    add_indirect(frame);
    return {};
}

std::vector<std::pair<std::string, double>> PathsEngine::stats() const {
    if (!relight_) return {{"gathering_points", 0}};
    const LightPaths& paths = relight_->bake().paths;
    return {{"gathering_points", paths.points.size()},
            {"gathering_rays", paths.rays.size()},
            {"entry_points", paths.entries.sides.size()},
            {"leaves", paths.groups.leaves},
            {"groups", paths.groups.count()},
            {"lamps_computed", entry_light_.computed()},
            {"pixels_searched", pixel_points_.searched()},
            {"lonely_pixels", alone_}};
}

}  // namespace
}  // namespace paths

EngineEntry paths_engine() {
    return {paths::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<paths::PathsEngine>(); }};
}

}  // namespace lucarne::gi
