#include "gi/engines/paths/paths.h"

#include <algorithm>
#include <functional>
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
#include "gi/engines/paths/moved_rays.h"
#include "gi/engines/paths/native/grid_light.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/paths/pixel_points.h"
#include "gi/engines/paths/point_sky.h"
#include "gi/engines/paths/relight.h"
#include "gi/engines/paths/seen_points.h"
#include "gi/engines/paths/sky_rays.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/gather_sky.h"
#include "gi/gather/traced_lights.h"
#include "gi/gather/upsample.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/nested_views.h"
#include "gi/native/reflectance.h"
#include "gi/shared/brdf.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace paths {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info,         &kOnlyBounce.info,   &kPointSpacing.info,
                                          &kGatherRays.info,      &kEntryPoints.info,  &kTransport.info,
                                          &kSkyLight.info,        &kGatherEvery.info,  &kShadows.info,
                                          &kLightResolution.info, &kLightSamples.info, &kSeed.info};
constexpr EngineInfo kInfo{.name = "paths",
                           .label = "Light paths in advance",
                           .description = "light paths computed in advance: lamps move with all bounces",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true},
                           .precomputes = &kPathsPrecomputes};

/// At rest, pixels between fewer of the places that gather than this gather themselves.
constexpr float kLeastBetween = 0.9f;

bool are_glossy(std::span<const Material> materials) {
    return std::ranges::any_of(materials, [](const Material& m) { return m.diffuse.w > 0; });
}

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
        bool is_traced = false;     ///< shadows by rays, not by maps
        bool operator==(const Basis&) const = default;
    };
    Result<void> add_direct(Frame& frame, const std::vector<LightView>& views, bool any_state);
    const SkyDirections& sky_directions(const EngineSettings& settings) const;
    const PointSky* point_sky(const EngineSettings& settings);
    Result<void> bounce(Frame& frame, const std::vector<LightView>& views, bool any_state);
    Result<void> relight(Frame& frame, const std::vector<LightView>& views, bool any_state);
    const ArrivingLight* arriving_light(Frame& frame, std::span<const Material> materials);
    const MovedRays* moved_rays(Frame& frame);
    /// Calls visit(i, points, start) as PixelPoints; `start`: of the rays of pixels at rest.
    using Visit = std::function<void(size_t, std::span<const PointShare>, const glm::vec3&)>;
    glm::vec3 light_at(const Frame& frame, const glm::vec3& start, const glm::vec3& normal,
                       std::span<const PointShare> about, const MovedRays* moved) const;
    void visit_points(const Frame& frame, PixelPoints::List list, std::span<const SurfacePoint> surfaces,
                      const Visit& visit);
    void add_by_grid(const Frame& frame, std::span<const Material> materials,
                     std::span<const GBufferTexel> texels, uint32_t step, const MovedRays* moved,
                     std::span<glm::vec4> radiance);
    void add_indirect(Frame& frame);

    SceneRevisions scene_;
    LightCutRevisions cuts_;
    Buffer materials_;
    Sky sky_;
    GatherSky even_sky_;
    SkyDirections bright_sky_;             ///< its very bright part, which few rays would miss
    std::optional<uint64_t> even_sky_of_;  ///< revision of the environment that both are made from
    std::optional<PointSky> point_sky_;    ///< even_sky_ at the points of the bake; made on first use
    std::optional<uint64_t> point_sky_of_;
    LightGBuffers light_gbuffers_;
    uint64_t light_index_ = 0;  ///< Frame::index by which lights with a size are sampled
    LightCutTracer tracer_;
    EntryLight entry_light_;
    std::unique_ptr<Relight> relight_;
    Basis light_of_;
    std::vector<glm::vec3> irradiance_;      ///< at gathering points; empty: not known
    std::vector<glm::vec3> sky_irradiance_;  ///< likewise, what comes straight from the sky; empty: nothing
    std::optional<ArrivingLight> arriving_;  ///< for glossy surfaces
    std::optional<MovedRays> moved_;         ///< for pixels at rest
    bool arriving_is_old_ = true, moved_is_old_ = true;
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
        point_sky_.reset();
        point_sky_of_.reset();
        irradiance_.clear();
        arriving_.reset();
        moved_.reset();
        pixel_points_ = PixelPoints();
    }
    LUCARNE_TRY(upload_sky(frame, sky_));
    if (even_sky_of_ != scene_.environment) {
        even_sky_ = gather_sky(frame.environment);
        bright_sky_ = SkyDirections(even_sky_.bright);
        even_sky_of_ = scene_.environment;
    }
    return upload_materials(frame.gl.device, frame.materials, materials_);
}

/// Adds the first reflection of the lights. `any_state`: maps of an earlier state of their cuts will do.
Result<void> PathsEngine::add_direct(Frame& frame, const std::vector<LightView>& views, bool any_state) {
    Device& device = frame.gl.device;
    if (traces_shadows(frame)) {
        timed(frame, "direct light",
              [&] { add_traced_light(frame, *tracer_, sky_directions(frame.settings)); });
        return {};
    }
    for (const LightView& from : views) {
        if (frame.stopped()) return {};
        LUCARNE_ASSIGN(const GBuffer* seen, timed(frame, "light G-buffer", [&] {
                           return any_state ? light_gbuffers_.look_at_any_state(device, from)
                                            : light_gbuffers_.look(device, from);
                       }));
        LUCARNE_TRY(timed(frame, "direct light", [&] { return add_light(frame, materials_, from, *seen); }));
    }
    return {};
}

/// Returns the part of the sky that lights by its directions: all of it, unless rays of the bake see the
/// rest.
const SkyDirections& PathsEngine::sky_directions(const EngineSettings& settings) const {
    const bool by_points = relight_ && !relight_->bake().paths.points.empty();
    return by_points && settings[kSkyLight] == SkyLight::links ? bright_sky_ : sky_.directions;
}

/// Returns the sky that gathering points see directly; null if they see none.
const PointSky* PathsEngine::point_sky(const EngineSettings& settings) {
    if (!relight_ || relight_->bake().paths.points.empty() || settings[kSkyLight] != SkyLight::links ||
        even_sky_.texels.empty() || !wants_direct(settings))
        return nullptr;
    if (!point_sky_) point_sky_.emplace(relight_->shared_bake());
    if (point_sky_of_ != scene_.environment) {
        point_sky_->set(even_sky_);
        point_sky_of_ = scene_.environment;
    }
    return &*point_sky_;
}

/// Sets the light of all groups.
Result<void> PathsEngine::bounce(Frame& frame, const std::vector<LightView>& views, bool any_state) {
    const EngineSettings& s = frame.settings;
    const std::vector<Material> materials = device_materials(frame.materials);
    LampLight entering;
    {
        const TimedPass pass(frame, "entry points");
        LUCARNE_TRY(entry_light_.set_entries(frame, relight_->shared_bake()));
        LUCARNE_ASSIGN(entering,
                       entry_light_.light(frame, views, light_gbuffers_, any_state,
                                          traces_shadows(frame) ? tracer_.get() : nullptr,
                                          are_glossy(materials) ? materials : std::span<const Material>()));
    }
    if (frame.stopped()) return {};
    const bool only = s[kOnlyBounce] >= 0;
    const auto last = only ? static_cast<uint32_t>(s[kOnlyBounce]) : s[kBounces];
    timed(frame, "photon energies", [&] {
        relight_->enter(materials, entering.irradiance,
                        s[kSkyLight] == SkyLight::links ? &even_sky_ : nullptr, entering.directions);
    });
    timed(frame, "bounces", [&] { relight_->bounce({only ? last : 1, last}, s[kTransport]); });
    return {};
}

/// Brings the light at the gathering points up to date.
Result<void> PathsEngine::relight(Frame& frame, const std::vector<LightView>& views, bool any_state) {
    Basis basis{scene_, cuts_, {}, traces_shadows(frame)};
    const auto lights_of_views = [&] {
        std::vector<Light> lights;
        for (const LightView& view : views) {
            const Light light = basis.is_traced ? without_nested_views(view.light) : view.light;
            if (!basis.is_traced || lights.empty() || lights.back() != light) lights.push_back(light);
        }
        return lights;
    };
    // In motion nodes arrive all the time, and light of a moment ago will do.
    if (any_state) basis.cuts = light_of_.cuts;
    // Light by rays stays while the camera moves.
    const bool is_traced = std::exchange(basis.is_traced, basis.is_traced || light_of_.is_traced);
    basis.lights = lights_of_views();
    if (!irradiance_.empty() && light_of_ == basis) return {};
    basis.is_traced = is_traced;
    basis.lights = lights_of_views();
    basis.cuts = cuts_;
    irradiance_.clear();
    const bool indirect = wants_indirect(frame.settings);
    if (indirect) LUCARNE_TRY(bounce(frame, views, any_state));
    if (frame.stopped()) return {};
    const TimedPass pass(frame, "final gathering");
    const PointSky* sky = point_sky(frame.settings);
    std::vector<glm::vec3> light =
        indirect ? relight_->gather()
                 : std::vector<glm::vec3>(relight_->bake().paths.points.size(), glm::vec3(0.0f));
    irradiance_ = smooth(relight_->bake(), light);
    sky_irradiance_.clear();
    if (sky) {
        sky_irradiance_ = smooth(relight_->bake(), sky->irradiance());
        for (size_t i = 0; i < irradiance_.size(); ++i) irradiance_[i] += sky_irradiance_[i];
    }
    arriving_is_old_ = moved_is_old_ = true;
    light_of_ = std::move(basis);
    return {};
}

/// Returns the light for glossy surfaces; null if no material is glossy.
const ArrivingLight* PathsEngine::arriving_light(Frame& frame, std::span<const Material> materials) {
    if (!are_glossy(materials)) return nullptr;
    if (!arriving_) arriving_.emplace(relight_->shared_bake());
    if (std::exchange(arriving_is_old_, false))
        timed(frame, "light by direction", [&] {
            const std::span radiosity =
                wants_indirect(frame.settings) ? relight_->radiosity() : std::span<const glm::vec3>();
            const std::span of_lobes =
                wants_indirect(frame.settings) ? relight_->lobe_light() : std::span<const glm::vec3>();
            arriving_->set(radiosity, of_lobes, point_sky(frame.settings), materials);
        });
    return &*arriving_;
}

/// Returns the rays by which light at pixels differs from that at gathering points; null in motion, and where
/// nothing bounces.
const MovedRays* PathsEngine::moved_rays(Frame& frame) {
    if (!traces_shadows(frame) || !wants_indirect(frame.settings)) return nullptr;
    if (!moved_) moved_.emplace(relight_->shared_bake());
    if (std::exchange(moved_is_old_, false)) moved_->set(relight_->radiosity(), relight_->lobe_light());
    return &*moved_;
}

/// Returns the irradiance at a place, W/m^2, from that of the points about it. `start`: of its rays; `moved`:
/// of moved_rays().
glm::vec3 PathsEngine::light_at(const Frame& frame, const glm::vec3& start, const glm::vec3& normal,
                                std::span<const PointShare> about, const MovedRays* moved) const {
    const glm::vec3 light = irradiance_of(about, irradiance_);
    if (!moved || about.empty() || frame.stopped()) return light;
    const glm::vec3 sky = sky_irradiance_.empty() ? glm::vec3(0.0f) : irradiance_of(about, sky_irradiance_);
    return sky + moved->factor(start - frame.bake_offset, normal, about) * (light - sky);
}

/// Visits the gathering points of pixels, as PixelPoints; at rest those that pixels see.
void PathsEngine::visit_points(const Frame& frame, PixelPoints::List list,
                               std::span<const SurfacePoint> surfaces, const Visit& visit) {
    const auto visit_all = [&](size_t i, std::span<const PointShare> about) {
        visit(i, about, surfaces[i].position);
    };
    if (!traces_shadows(frame)) return pixel_points_.visit(list, surfaces, visit_all);
    const SeenPoints points(*tracer_, relight_->bake(), frame.bake_offset, irradiance_);
    pixel_points_.visit(list, surfaces, [&](size_t i, std::span<const PointShare> about) {
        if (frame.stopped()) return visit_all(i, about);
        const glm::vec3 start = start_of_rays(*tracer_, surfaces[i]);
        std::vector<PointShare> seen;
        visit(i, points.about(surfaces[i], start, about, seen), start);
    });
}

/// Finds the light at one pixel in each square of `step`, and adds what all pixels reflect: between these it
/// is interpolated where they lie in one plane.
void PathsEngine::add_by_grid(const Frame& frame, std::span<const Material> materials,
                              std::span<const GBufferTexel> texels, uint32_t step, const MovedRays* moved,
                              std::span<glm::vec4> radiance) {
    // The places do not move from frame to frame, or their points would have to be found again.
    const GatherGrid grid{frame.camera.width, frame.camera.height, step, step / 2, step / 2};
    std::vector<uint32_t> pixels;
    for (uint32_t row = 0; row < grid.rows(); ++row)
        for (uint32_t column = 0; column < grid.columns(); ++column)
            pixels.push_back(grid.pixel(column, row));
    const std::vector<SurfacePoint> places = visible_surfaces(frame.camera, texels, pixels);
    std::vector<native::GridLight> lights(pixels.size());
    using About = std::span<const PointShare>;
    visit_points(frame, PixelPoints::List::grid, places, [&](size_t i, About about, const glm::vec3& start) {
        lights[i] = {places[i].position - glm::vec3(frame.camera.origin), 1, places[i].normal,
                     light_at(frame, start, places[i].normal, about, moved)};
    });
    const gi::native::DiffuseTables reflectances(materials);
    const std::vector<uint32_t> rest = native::add_grid_light(
        {frame.camera, texels, grid, lights, reflectances, radiance, moved ? kLeastBetween : 0});
    const std::vector<SurfacePoint> others = visible_surfaces(frame.camera, texels, rest);
    visit_points(frame, PixelPoints::List::rest, others, [&](size_t i, About about, const glm::vec3& start) {
        const Reflectance r =
            make_reflectance(materials[others[i].material % materials.size()], others[i].albedo);
        radiance[rest[i]] +=
            glm::vec4(r.kd / kPi * light_at(frame, start, others[i].normal, about, moved), 0);
    });
}

/// Adds what pixels reflect of the light at the gathering points about them.
void PathsEngine::add_indirect(Frame& frame) {
    const PathsBake& bake = relight_->bake();
    const std::vector<Material> materials = device_materials(frame.materials);
    const ArrivingLight* glossy = arriving_light(frame, materials);
    const MovedRays* moved = moved_rays(frame);
    const TimedPass pass(frame, "interpolation");
    const std::vector<GBufferTexel> texels = download_gbuffer(frame);
    auto radiance = frame.gl.radiance.download_all<glm::vec4>(texels.size());
    std::optional<SkyRays> sky_rays;
    if (traces_shadows(frame) && !sky_irradiance_.empty())
        sky_rays.emplace(*tracer_, even_sky_, *point_sky_, sky_irradiance_);
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    // Lobes and rays need the points of each pixel.
    const uint32_t step = glossy || sky_rays ? 1 : frame.settings[kGatherEvery];
    // Where rays move, more pixels look for points of their own (add_by_grid()).
    pixel_points_.begin(bake, frame.camera, texels, frame.bake_offset, 2 * uint64_t{step} + (moved ? 1 : 0));
    if (step > 1) {
        add_by_grid(frame, materials, texels, step, moved, radiance);
    } else {
        const std::vector<SurfacePoint> surfaces = visible_surfaces(frame.camera, texels);
        visit_points(
            frame, PixelPoints::List::grid, surfaces,
            [&](size_t i, std::span<const PointShare> about, const glm::vec3& start) {
                if ((about.empty() && !sky_rays) || frame.stopped()) return;
                const SurfacePoint& at = surfaces[i];
                glm::vec3 irradiance = light_at(frame, start, at.normal, about, moved);
                if (sky_rays)
                    irradiance = glm::max(
                        irradiance + sky_rays->correction(at, start, about, mix64(~seed + 1, i)), 0.0f);
                const Reflectance r = make_reflectance(materials[at.material % materials.size()], at.albedo);
                glm::vec3 reflected = r.kd / kPi * irradiance;
                if (glossy && r.ks > 0 && !about.empty())
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
    const bool direct = wants_direct(s), at_points = relight_ && (wants_indirect(s) || point_sky(s));
    alone_ = 0;
    if (!direct && !at_points) return {};
    if (direct)
        LUCARNE_TRY(timed(frame, "emission", [&] { return add_own_light(frame, materials_, sky_, false); }));
    if (traces_shadows(frame)) LUCARNE_TRY(tracer_.update(frame, cuts_.light));
    // In motion shadows may be those of a moment ago; they are renewed as far as the time goes.
    const bool in_parts = frame.moving && !frame.light_budget.whole();
    if (!in_parts) light_index_ = frame.index;
    const std::vector<LightView> views = light_views(frame, sky_directions(s), light_index_);
    Device& device = frame.gl.device;
    light_gbuffers_.begin(device, views, views.size());
    if (in_parts) LUCARNE_TRY(light_gbuffers_.renew(frame, views));
    if (direct) LUCARNE_TRY(add_direct(frame, views, in_parts));
    if (!at_points || frame.stopped()) return {};
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
