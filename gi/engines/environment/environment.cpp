#include "gi/engines/environment/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/engines/environment/caches.h"
#include "gi/engines/environment/glossy_caches.h"
#include "gi/engines/environment/kept_caches.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/environment/primaries.h"
#include "gi/engines/environment/secondaries.h"
#include "gi/gather/final_gather.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/tree_lighting.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace environment {
namespace {

constexpr const OptionInfo* kOptions[] = {&kBounces.info,      &kOnlyBounce.info,      &kMicroBuffer.info,
                                          &kCacheSpacing.info, &kRadiosityLevel.info,  &kGatherEvery.info,
                                          &kShadows.info,      &kLightResolution.info, &kLightSamples.info,
                                          &kGlossyCaches.info, &kBruteForce.info,      &kSeed.info};
constexpr EngineInfo kInfo{
    .name = "environment",
    .label = "Environment lighting",
    .description = "light of the sky and between surfaces, gathered at visible points, on OpenCL",
    .options = kOptions,
    .needs = {.light_cut = true, .light_views = true, .opencl = true},
    .reports_progress = true};

constexpr size_t kPointsATask = 256;
constexpr uint32_t kSecondarySide = 8;    ///< of the micro-buffers at secondary points
constexpr size_t kMostPrimaries = 65536;  ///< their micro-buffers take up to 340 MB
/// Secondary points are four times as far apart as caches in a picture of about this side, pixels, and in
/// others as far apart in the scene: what they light by one more reflection is no finer in larger pictures.
/// Caches are as many pixels apart as asked in such a picture and in smaller ones, and in one of four times
/// the side twice as many: less in the scene, but not as much as pixels shrink.
constexpr float kCoarser = 4, kUsualSide = 250;
constexpr float kReach = 3;               ///< of a cache, in radii of its node
constexpr float kLeastReach = 1.2f;       ///< likewise, beside other surfaces
constexpr float kShareOfDistance = 0.7f;  ///< the reach beside other surfaces, of their harmonic distance
/// Caches share their light over this share of their harmonic distance, at most so many radii. Most of it
/// may come from small windows or patches of sun, which few rays meet: with their reach, walls had blotches.
constexpr float kShareToSmooth = 0.1f, kReachToSmooth = 8;
constexpr size_t kMostSecondariesHeld = 262144;  ///< their micro-buffers take 85 MB; more are not kept
constexpr uint32_t kRepairSpacing = 4;           ///< pixels between those lonely ones that gather first
constexpr size_t kRepairsAtOnce = 16384;         ///< micro-buffers of lonely pixels
constexpr size_t kRepairsInMotion = 2048;        ///< likewise, in a frame of a motion

class EnvironmentEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;
    bool keeps_light(const EngineSettings& settings, uint64_t content) const override {
        return kept_.hold(settings, content);
    }

 protected:
    void update(const Changes& changes) override { lighting_.update(changes); }
    Result<void> prepare(Frame& frame) override { return lighting_.prepare(frame, kInfo.name); }
    Result<void> render(Frame& frame) override;

 private:
    Result<void> gather(Frame& frame);
    Result<void> light_secondaries(Frame& frame, std::span<const SidePlace> primaries);
    Result<std::vector<glm::vec3>> irradiance_at(Frame& frame, std::span<const uint32_t> sides,
                                                 Gathered what);
    Result<void> add_caches(Frame& frame, std::span<const SidePlace> primaries, Gathered what, bool glossy);
    Result<std::vector<LightByNormal>> shade(const Frame& frame, Gathered what, const MicroBuffers& buffers);
    Result<std::vector<LightByDirection>> shade_by_direction(const Frame& frame, Gathered what,
                                                             const MicroBuffers& buffers);
    template <class Light>
    void add_bright(const Frame& frame, Gathered what, std::span<const GatherPoint> points,
                    std::span<Light> light) const;
    Result<void> find_openings(Frame& frame, std::span<const SurfacePoint> surfaces);
    Result<void> find_bright(Frame& frame, std::span<const SurfacePoint> surfaces);
    Result<std::vector<Cache>> gather_at(Frame& frame, std::span<const SurfacePoint> surfaces,
                                         std::span<const uint32_t> pixels, float spacing, Gathered what,
                                         std::span<glm::vec4> light, MicroBuffers& buffers);
    Result<void> repair(Frame& frame, std::span<const SurfacePoint> surfaces, std::vector<uint32_t> lonely,
                        Gathered what, std::vector<glm::vec4>& light);
    Result<void> follow(Frame& frame);
    Result<void> reflect_and_upload(Frame& frame, Gathered what, std::vector<SurfacePoint> surfaces,
                                    std::span<const Cache> caches, CachedLobes lobes,
                                    std::vector<glm::vec4>& light);

    void report(Frame& frame, double share);

    /// What the choice of secondary points depends on, beside the tree that micro-buffers belong to.
    struct SecondariesOf {
        uint64_t buffers;  ///< MicroBuffers::drawing()
        CameraView camera;
        float spacing;
        bool operator==(const SecondariesOf&) const = default;
    };

    /// Likewise for the irradiance that was gathered at secondary points.
    struct GatheredOf {
        uint64_t light, seed;
        Gathered what;
        bool operator==(const GatheredOf&) const = default;
    };

    TreeLighting lighting_;
    MicroBuffers buffers_, secondary_buffers_;
    std::array<MicroBuffers, 2> repairs_;  ///< of lonely pixels: of some of them, and of what is left
    Secondaries secondaries_;
    std::optional<SecondariesOf> secondaries_of_;
    /// Irradiance by side, W/m^2, that secondary points of this and of earlier views have gathered. Of the
    /// view only their rays depend: those that are drawn together share a turn of them.
    std::unordered_map<uint32_t, glm::vec3> gathered_;
    std::optional<GatheredOf> gathered_of_;
    std::vector<Cache> caches_;
    KeptCaches kept_;
    bool lit_ = false;  ///< the light that surfels send out is there: the last frame was finished
    GatherCounts lobes_;
    const SkyOpenings* openings_ = nullptr;  ///< of the frame; none: buffers find all of the sky
    const BrightLight* bright_ = nullptr;    ///< likewise, of what surfels send out
    std::vector<LightByNormal> sky_;         ///< what primary points receive of it in the frame
    uint64_t seed_ = 0;
    size_t primaries_ = 0, seen_ = 0, known_ = 0, gathering_ = 0, repaired_ = 0, reported_ = 0;
};

/// What pixels show: of the light that surfels send out, and of the sky.
Gathered shown(const EngineSettings& s, bool sky) {
    if (!wants_indirect(s)) return Gathered::sky;
    return wants_direct(s) && sky ? Gathered::both : Gathered::light_of_surfels;
}

GatherPoint point_at(const glm::vec3& position, const glm::vec3& normal, float lift, uint64_t seed) {
    return {.position = position,
            .lift = lift,
            .normal = normal,
            .seed = static_cast<uint32_t>(seed),
            .viewer = glm::vec3(0.0f),
            .exponent = 0,
            .axis = normal,
            .scale = 1};
}

/// Returns the side of a square picture of as many pixels, in sides of a usual one.
float relative_side(const CameraView& camera) {
    return std::sqrt(static_cast<float>(camera.width) * static_cast<float>(camera.height)) / kUsualSide;
}

/// Returns those of the pixels that lie on a grid of this spacing.
std::vector<uint32_t> every(uint32_t spacing, const CameraView& camera, std::span<const uint32_t> pixels) {
    std::vector<uint32_t> chosen;
    for (const uint32_t pixel : pixels)
        if ((pixel % camera.width) % spacing == spacing / 2 &&
            (pixel / camera.width) % spacing == spacing / 2)
            chosen.push_back(pixel);
    return chosen;
}

/// Returns the pixels that show a surface.
std::vector<uint32_t> pixels_of(std::span<const SurfacePoint> surfaces) {
    std::vector<uint32_t> pixels;
    for (uint32_t i = 0; i < surfaces.size(); ++i)
        if (surfaces[i].radius > 0) pixels.push_back(i);
    return pixels;
}

/// Reports this share of the picture as finished.
void EnvironmentEngine::report(Frame& frame, double share) {
    if (!frame.progress) return;
    const auto pixels = static_cast<size_t>(share * frame.camera.width * frame.camera.height);
    frame.progress->add(pixels - reported_);
    reported_ = pixels;
}

/// Sets the light of the surfels, and what they reflect of the sky and of each other up to the last bounce.
Result<void> EnvironmentEngine::light_secondaries(Frame& frame, std::span<const SidePlace> primaries) {
    const EngineSettings& s = frame.settings;
    const bool only = s[kOnlyBounce] >= 0, sky = lighting_.has_sky();
    const uint32_t bounces = only ? static_cast<uint32_t>(s[kOnlyBounce]) : s[kBounces];
    // What arrives at secondary points: the sky, and after the second bounce the light of other surfels.
    const bool farther = bounces > 1;
    LUCARNE_TRY(lighting_.make_light(frame, {.bounces = farther ? bounces - 2 : 0,
                                             .sky = sky && farther,
                                             .only_last = only,
                                             .side = kSecondarySide,
                                             .seed = seed_}));
    if (frame.stopped() || (!farther && !sky)) return {};
    const Gathered arriving = !farther       ? Gathered::sky
                              : only || !sky ? Gathered::light_of_surfels
                                             : Gathered::both;
    const SurfelTree& tree = lighting_.lit().tree();
    {
        const TimedPass pass(frame, "secondary points");
        const float spacing = kCoarser * relative_side(frame.camera) * static_cast<float>(s[kCacheSpacing]);
        const SecondariesOf basis{buffers_.drawing(), frame.camera, spacing};
        if (s[kBruteForce]) {
            secondaries_.choose_all(tree);
            secondaries_of_.reset();
        } else if (secondaries_of_ != basis) {
            LUCARNE_ASSIGN(const auto seen, buffers_.seen());
            secondaries_.choose(tree, seen,
                                [&](size_t slot) { return shares_light(tree, slot, frame.camera, spacing); });
            secondaries_of_ = basis;
        }
        seen_ = secondaries_.seen();
        known_ = secondaries_.sides().size();
    }
    caches_.clear();
    if (!s[kBruteForce]) LUCARNE_TRY(add_caches(frame, primaries, arriving, false));
    LUCARNE_ASSIGN(const auto known, irradiance_at(frame, secondaries_.sides(), arriving));
    if (frame.stopped()) return {};
    const TimedPass pass(frame, "propagation");
    return lighting_.set_irradiance(secondaries_.propagate(tree, known), !only || bounces == 1);
}

/// Returns the irradiance of sides, W/m^2: from the caches about them, or by gathering.
Result<std::vector<glm::vec3>> EnvironmentEngine::irradiance_at(Frame& frame, std::span<const uint32_t> sides,
                                                                Gathered what) {
    const TimedPass pass(frame, "light at secondary points");
    const CameraView& camera = frame.camera;
    const CacheTiles tiles(camera, caches_);
    const GatheredOf basis{lighting_.light_number(), seed_, what};
    if (gathered_of_ != basis || gathered_.size() > kMostSecondariesHeld) gathered_.clear();
    gathered_of_ = basis;
    std::vector<CacheTiles::Counting> room;
    std::vector<glm::vec3> irradiances(sides.size(), glm::vec3(0.0f));
    std::vector<GatherPoint> points;
    std::vector<size_t> places;
    for (size_t i = 0; i < sides.size(); ++i) {
        const SidePlace place = place_of(lighting_.lit().tree(), lighting_.lit().surfels(), sides[i]);
        float depth = 0;
        const glm::vec2 at = view_place(camera, place.position, depth);
        if (depth > 0 || is_parallel(camera)) {
            const SurfacePoint surface{
                .position = place.position, .normal = place.normal, .radius = place.radius};
            if (const auto found = tiles.light_at(surface, at, room)) {
                irradiances[i] = kPi * found->on(place.normal);
                continue;
            }
        }
        if (const auto known = gathered_.find(sides[i]); known != gathered_.end()) {
            irradiances[i] = known->second;
            continue;
        }
        points.push_back(point_at(place.position, place.normal, place.radius, mix64(seed_ + 1, sides[i])));
        places.push_back(i);
    }
    gathering_ = points.size();
    if (points.empty()) return irradiances;  // buffers stay, for other light
    Gatherer& gatherer = lighting_.gatherer();
    if (points.size() > kMostSecondariesHeld) {
        std::vector<glm::vec4> gathered(points.size());
        LUCARNE_TRY(
            gatherer.gather(lighting_.opencl(), what, points, kSecondarySide, seed_, gathered, frame.stop));
        for (size_t i = 0; i < places.size(); ++i) irradiances[places[i]] = kPi * glm::vec3(gathered[i]);
        return irradiances;
    }
    LUCARNE_TRY(
        gatherer.see(lighting_.opencl(), points, kSecondarySide, seed_, secondary_buffers_, frame.stop));
    if (frame.stopped()) return irradiances;
    LUCARNE_ASSIGN(const auto gathered, gatherer.shade(lighting_.opencl(), what, secondary_buffers_));
    for (size_t i = 0; i < places.size(); ++i) {
        irradiances[places[i]] = kPi * gathered[i].on(points[i].normal);
        gathered_.emplace(sides[places[i]], irradiances[places[i]]);
    }
    return irradiances;
}

/// Returns so many points that pixels show, from all over the picture.
std::vector<GatherPoint> pilots_of(std::span<const SurfacePoint> surfaces, size_t count, uint64_t seed) {
    const std::vector<uint32_t> pixels = pixels_of(surfaces);
    std::vector<GatherPoint> pilots;
    const size_t all = std::min(count, pixels.size());
    for (size_t i = 0; i < all; ++i) {
        const SurfacePoint& at = surfaces[pixels[i * pixels.size() / all]];
        pilots.push_back(point_at(at.position, at.normal, at.radius, mix64(seed, i)));
        pilots.back().viewer = at.viewer;
    }
    return pilots;
}

Result<void> EnvironmentEngine::find_openings(Frame& frame, std::span<const SurfacePoint> surfaces) {
    // The sky's light reaches pixels at once, or by one reflection.
    if (!lighting_.has_sky() || frame.moving || frame.settings[kOnlyBounce] > 1) return {};
    const TimedPass pass(frame, "openings to the sky");
    const auto pilots = pilots_of(surfaces, SkyOpenings::kPilots, seed_ + 3);
    LUCARNE_ASSIGN(openings_, lighting_.find_openings(frame, pilots, seed_));
    return {};
}

/// Finds what is bright of the surfels' own light, if pixels show it reflected.
Result<void> EnvironmentEngine::find_bright(Frame& frame, std::span<const SurfacePoint> surfaces) {
    const EngineSettings& s = frame.settings;
    if (!wants_indirect(s) || s[kOnlyBounce] > 1 || frame.moving) return {};
    const TimedPass pass(frame, "bright light");
    const auto pilots = pilots_of(surfaces, BrightLight::kPilots, seed_ + 4);
    LUCARNE_ASSIGN(bright_, lighting_.find_bright(frame, pilots, shown(s, lighting_.has_sky()), seed_));
    return {};
}

/// Lights the micro-buffers of points that pixels show. They cast rays of their own at openings to the sky
/// and at what is bright. Those of secondary points would take as long as their buffers and gain nothing
/// (openings, FLIP of a loft by day: .1617, .1612 without).
Result<std::vector<LightByNormal>> EnvironmentEngine::shade(const Frame& frame, Gathered what,
                                                            const MicroBuffers& buffers) {
    Gatherer& gatherer = lighting_.gatherer();
    LUCARNE_TRY(gatherer.set_openings(lighting_.opencl(), openings_, SkyOpenings::kRays));
    LUCARNE_ASSIGN(auto light, gatherer.shade(lighting_.opencl(), what, buffers, frame.stop));
    gatherer.set_no_openings();
    add_bright(frame, what, buffers.points(), std::span(light));
    return light;
}

Result<std::vector<LightByDirection>> EnvironmentEngine::shade_by_direction(const Frame& frame, Gathered what,
                                                                            const MicroBuffers& buffers) {
    Gatherer& gatherer = lighting_.gatherer();
    LUCARNE_TRY(gatherer.set_openings(lighting_.opencl(), openings_, SkyOpenings::kRays));
    LUCARNE_ASSIGN(auto light, gatherer.shade_by_direction(lighting_.opencl(), what, buffers, frame.stop));
    gatherer.set_no_openings();
    add_bright(frame, what, buffers.points(), std::span(light));
    return light;
}

/// Adds what VPLs bring to points.
template <class Light>
void EnvironmentEngine::add_bright(const Frame& frame, Gathered what, std::span<const GatherPoint> points,
                                   std::span<Light> light) const {
    if (!bright_ || what == Gathered::sky) return;
    parallel_ranges(points.size(), kPointsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !frame.stopped(); ++i)
            bright_->each(points[i], points[i].seed,
                          [&](const glm::vec3& direction, const glm::vec3& arriving) {
                              light[i].add_ray(points[i].normal, direction, arriving);
                          });
    });
}

/// Lights the micro-buffers of the primary points. `glossy`: also by direction, if they are not too many.
Result<void> EnvironmentEngine::add_caches(Frame& frame, std::span<const SidePlace> primaries, Gathered what,
                                           bool glossy) {
    const TimedPass pass(frame, "caches");
    // The sky is the same for secondary points and for pixels.
    if (what != Gathered::light_of_surfels && sky_.empty()) {
        LUCARNE_ASSIGN(sky_, shade(frame, Gathered::sky, buffers_));
    }
    std::vector<LightByNormal> light(buffers_.count());
    if (what != Gathered::sky) {
        LUCARNE_ASSIGN(light, shade(frame, Gathered::light_of_surfels, buffers_));
    }
    if (what != Gathered::light_of_surfels)
        for (size_t i = 0; i < light.size(); ++i) light[i].add(sky_[i], 1);
    std::vector<LightByDirection> by_direction;
    if (glossy && light.size() <= kMostGlossyCaches) {
        LUCARNE_ASSIGN(by_direction, shade_by_direction(frame, what, buffers_));
    }
    LUCARNE_ASSIGN(const auto nearness, buffers_.nearness());
    caches_.clear();
    std::vector<float> reaches;
    for (size_t i = 0; i < primaries.size(); ++i) {
        const SidePlace& place = primaries[i];
        const float distance = 1 / std::max(nearness[i], 1e-9f);  // harmonic mean
        const float reach =
            std::clamp(kShareOfDistance * distance, kLeastReach * place.size, kReach * place.size);
        caches_.push_back(
            {place.position, place.normal, reach, light[i],
             by_direction.empty() ? nullptr : std::make_shared<LightByDirection>(by_direction[i])});
        reaches.push_back(std::clamp(kShareToSmooth * distance, reach, kReachToSmooth * place.size));
    }
    smooth(frame.camera, caches_, reaches);
    return {};
}

/// Gathers the light of these pixels, about `spacing` pixels apart. Returns caches for those between them.
/// `buffers` are kept for the same pixels under other light, if they are few enough.
Result<std::vector<Cache>> EnvironmentEngine::gather_at(Frame& frame, std::span<const SurfacePoint> surfaces,
                                                        std::span<const uint32_t> pixels, float spacing,
                                                        Gathered what, std::span<glm::vec4> light,
                                                        MicroBuffers& buffers) {
    const CameraView& camera = frame.camera;
    std::vector<Cache> caches;
    for (size_t first = 0; first < pixels.size(); first += kRepairsAtOnce) {
        if (frame.stopped()) break;
        const auto some = pixels.subspan(first, std::min(kRepairsAtOnce, pixels.size() - first));
        std::vector<GatherPoint> points;
        for (const uint32_t pixel : some) {
            const SurfacePoint& at = surfaces[pixel];
            points.push_back(point_at(at.position, at.normal, at.radius, mix64(seed_ + 2, pixel)));
            points.back().viewer = at.viewer;
        }
        LUCARNE_TRY(lighting_.gatherer().see(lighting_.opencl(), points, frame.settings[kMicroBuffer], seed_,
                                             buffers, frame.stop));
        if (frame.stopped()) break;
        LUCARNE_ASSIGN(const auto gathered, shade(frame, what, buffers));
        std::vector<LightByDirection> by_direction;
        if (glossy(frame) && caches_.size() + caches.size() + some.size() <= kMostGlossyCaches) {
            LUCARNE_ASSIGN(by_direction, shade_by_direction(frame, what, buffers));
        }
        for (size_t i = 0; i < gathered.size(); ++i) {
            const SurfacePoint& at = surfaces[some[i]];
            light[some[i]] = glm::vec4(gathered[i].on(at.normal), 0);
            float depth = 0;
            view_place(camera, at.position, depth);
            const float reach = 1.5f * spacing * pixel_height(camera, depth) + at.radius;
            caches.push_back(
                {at.position, at.normal, reach, gathered[i],
                 by_direction.empty() ? nullptr : std::make_shared<LightByDirection>(by_direction[i])});
        }
    }
    repaired_ += pixels.size();
    return caches;
}

/// Gathers light for pixels that no cache counts for: at some of them for those about them, and then at all
/// that are still lonely.
Result<void> EnvironmentEngine::repair(Frame& frame, std::span<const SurfacePoint> surfaces,
                                       std::vector<uint32_t> lonely, Gathered what,
                                       std::vector<glm::vec4>& light) {
    const TimedPass pass(frame, "lonely pixels");
    for (const uint32_t spacing : {kRepairSpacing, 1u}) {
        const std::vector<uint32_t> chosen = every(spacing, frame.camera, lonely);
        LUCARNE_ASSIGN(const auto caches, gather_at(frame, surfaces, chosen, static_cast<float>(spacing),
                                                    what, light, repairs_[spacing == 1 ? 1 : 0]));
        if (frame.stopped()) return {};
        if (spacing == 1) continue;
        lonely = interpolate(frame.camera, surfaces, lonely, caches, light);
        caches_.insert(caches_.end(), caches.begin(), caches.end());
    }
    return {};
}

/// Sets the picture to what pixels reflect of the light of surfels and of the sky.
Result<void> EnvironmentEngine::gather(Frame& frame) {
    const EngineSettings& s = frame.settings;
    LUCARNE_TRY(lighting_.make_tree(frame));
    const SurfelTree& tree = lighting_.lit().tree();
    const std::vector<SurfacePoint> surfaces = visible_surfaces(frame.camera, download_gbuffer(frame));
    std::vector<SidePlace> primaries;
    {
        const TimedPass pass(frame, "primary points");
        const float spacing =
            std::sqrt(std::max(relative_side(frame.camera), 1.0f)) * static_cast<float>(s[kCacheSpacing]);
        primaries =
            primary_places(tree, lighting_.lit().surfels(), frame.camera, surfaces, spacing, kMostPrimaries);
        primaries_ = primaries.size();
    }
    {
        const TimedPass pass(frame, "micro-buffers");
        std::vector<GatherPoint> points;
        for (const SidePlace& place : primaries) {
            points.push_back(point_at(place.position, place.normal, place.radius, mix64(seed_, place.side)));
            points.back().viewer = place.viewer;
        }
        LUCARNE_TRY(lighting_.gatherer().see(lighting_.opencl(), points, s[kMicroBuffer], seed_, buffers_,
                                             frame.stop));
    }
    if (frame.stopped()) return {};
    report(frame, 0.4);
    LUCARNE_TRY(find_openings(frame, surfaces));
    if (frame.stopped()) return {};
    if (wants_indirect(s)) LUCARNE_TRY(light_secondaries(frame, primaries));
    if (frame.stopped()) return {};
    LUCARNE_TRY(find_bright(frame, surfaces));
    if (frame.stopped()) return {};
    report(frame, 0.8);
    const Gathered what = shown(s, lighting_.has_sky());
    LUCARNE_TRY(add_caches(frame, primaries, what, glossy(frame)));
    std::vector<glm::vec4> light(surfaces.size(), glm::vec4(0.0f));
    std::vector<uint32_t> lonely;
    {
        const TimedPass pass(frame, "interpolation");
        lonely = interpolate(frame.camera, surfaces, pixels_of(surfaces), caches_, light);
    }
    LUCARNE_TRY(repair(frame, surfaces, std::move(lonely), what, light));
    if (frame.stopped()) return {};
    LUCARNE_TRY(reflect_and_upload(frame, what, surfaces, caches_, CachedLobes::wide, light));
    if (frame.stopped()) return {};
    lit_ = true;
    kept_.take(frame.camera, s, frame.content, caches_);
    return {};
}

/// Sets the picture to what pixels reflect of the light that they receive, by lobes of that of caches.
Result<void> EnvironmentEngine::reflect_and_upload(Frame& frame, Gathered what,
                                                   std::vector<SurfacePoint> surfaces,
                                                   std::span<const Cache> caches, CachedLobes lobes,
                                                   std::vector<glm::vec4>& light) {
    const std::vector<glm::vec4> received = glossy(frame) ? light : std::vector<glm::vec4>();
    const std::vector<Reflectance> reflectances = reflect_evenly(frame, surfaces, light);
    if (glossy(frame) && (lobes == CachedLobes::all || frame.settings[kGlossyCaches])) {
        const TimedPass pass(frame, "lobes");
        reflect_by_caches(frame, caches, lobes, reflectances, received, surfaces, light);
    }
    LUCARNE_TRY(reflect_by_lobes(frame, lighting_.opencl(), lighting_.gatherer(), what, std::move(surfaces),
                                 reflectances, light, lobes_));
    if (!frame.stopped()) upload_radiance(frame, light);
    return {};
}

/// Draws a frame of a motion with the light of the frames before it. Where that is not known, some pixels
/// gather if the last whole frame was finished, and what is left has the mean light of what is about it.
Result<void> EnvironmentEngine::follow(Frame& frame) {
    const Gathered what = shown(frame.settings, lighting_.has_sky());
    const std::vector<SurfacePoint> surfaces = visible_surfaces(frame.camera, download_gbuffer(frame));
    std::vector<glm::vec4> light(surfaces.size(), glm::vec4(0.0f));
    std::vector<uint32_t> lonely;
    {
        const TimedPass pass(frame, "interpolation");
        lonely = interpolate(frame.camera, surfaces, pixels_of(surfaces), kept_.all(), light);
    }
    if (lit_) {
        const TimedPass pass(frame, "lonely pixels");
        uint32_t spacing = kRepairSpacing;
        std::vector<uint32_t> chosen = every(spacing, frame.camera, lonely);
        while (chosen.size() > kRepairsInMotion) chosen = every(spacing *= 2, frame.camera, lonely);
        LUCARNE_ASSIGN(const auto caches, gather_at(frame, surfaces, chosen, static_cast<float>(spacing),
                                                    what, light, repairs_[0]));
        if (frame.stopped()) return {};
        lonely = interpolate(frame.camera, surfaces, lonely, caches, light);
        kept_.add(caches);
    }
    fill_by_means(frame.camera, surfaces, lonely, light);
    return reflect_and_upload(frame, what, surfaces, kept_.all(), CachedLobes::all, light);
}

Result<void> EnvironmentEngine::render(Frame& frame) {
    lighting_.begin(frame);
    openings_ = nullptr;
    bright_ = nullptr;
    lighting_.gatherer().set_no_bright();
    sky_.clear();
    frame.gl.radiance.clear(0);
    seed_ = mix64(frame.settings[kSeed], frame.index);
    primaries_ = seen_ = known_ = gathering_ = repaired_ = reported_ = 0;
    const bool direct = wants_direct(frame.settings);
    if (wants_indirect(frame.settings) || (direct && lighting_.has_sky())) {
        const bool in_parts = frame.moving && !frame.light_budget.whole();
        const bool follows = in_parts && keeps_light(frame.settings, frame.content);
        if (!follows) lit_ = false;
        LUCARNE_TRY(follows ? follow(frame) : gather(frame));
    }
    if (frame.stopped()) return {};
    if (direct) LUCARNE_TRY(lighting_.add_direct(frame));
    report(frame, 1);
    return {};
}

std::vector<std::pair<std::string, double>> EnvironmentEngine::stats() const {
    return {{"surfels", lighting_.lit().tree().leaves},
            {"primary_points", primaries_},
            {"secondary_points", seen_},
            {"after_up", known_},
            {"after_down", gathering_},
            {"lonely_pixels", repaired_}};
}

}  // namespace
}  // namespace environment

EngineEntry environment_engine() {
    return {environment::kInfo,
            []() -> std::unique_ptr<Engine> { return std::make_unique<environment::EnvironmentEngine>(); }};
}

}  // namespace lucarne::gi
