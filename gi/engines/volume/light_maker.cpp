#include "gi/engines/volume/light_maker.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/engines/volume/options.h"
#include "gi/host_frame.h"
#include "gi/shared/brdf.h"
#include "gi/shared/environment.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/log.h"
#include "io/core/random.h"

namespace lucarne::gi::volume {
namespace {

/// Voxels of transport sh: their lobes take 128 bytes each.
constexpr size_t kMostLobes = size_t{1} << 19;
/// The sky shines through small windows, so it is carried along so many times as many directions as a bounce.
constexpr uint32_t kSkyDirections = 4;
/// Rooms and streets are lost in larger voxels, m.
constexpr float kWideVoxel = 2;
/// Texels of the sky that one direction stands for.
constexpr int kSkySamples = 32;

/// Returns the mean radiance of the sky about the direction that light with this `way` comes from, over as
/// large a part of the sphere as one of `directions` stands for.
glm::vec3 sky_about(const GatherSky& sky, const glm::vec3& way, size_t directions) {
    if (sky.texels.empty()) return glm::vec3(0.0f);
    const float drop = 2.0f / static_cast<float>(std::max<size_t>(directions, 1));  // 1 - cosine of the cap
    glm::vec3 u, v, sum(0.0f);
    tracing::frame_of(-way, u, v);
    for (int i = 0; i < kSkySamples; ++i) {
        const float cosine = 1 - drop * (static_cast<float>(i) + 0.5f) / kSkySamples;
        const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
        const float phi = 2.39996323f * static_cast<float>(i);  // the golden angle
        const glm::vec3 direction =
            glm::normalize(u * (sine * std::cos(phi)) + v * (sine * std::sin(phi)) - way * cosine);
        const glm::vec2 place = environment_place(direction, sky.rotation);
        const auto x = static_cast<size_t>(place.x * static_cast<float>(sky.width));
        const auto y = static_cast<size_t>(place.y * static_cast<float>(sky.height));
        sum +=
            sky.texels[std::min<size_t>(y, sky.height - 1) * sky.width + std::min<size_t>(x, sky.width - 1)];
    }
    return sum / static_cast<float>(kSkySamples);
}

Basis without_frame(Basis basis) {
    basis.frame = 0;
    return basis;
}

/// What the light of surfels is made from.
Basis of_lights(Basis basis) {
    basis.focus = {};
    return without_frame(std::move(basis));
}

std::vector<glm::vec3> product(std::span<const glm::vec3> reflectances,
                               std::span<const glm::vec3> irradiance) {
    std::vector<glm::vec3> light(irradiance.size());
    for (size_t face = 0; face < light.size(); ++face) light[face] = reflectances[face] * irradiance[face];
    return light;
}

void add(std::vector<glm::vec3>& sum, std::span<const glm::vec3> more) {
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += more[i];
}

}  // namespace

void LightMaker::begin(Basis basis, const EngineSettings& settings) {
    basis_ = std::move(basis);
    const int32_t only = settings[kOnlyBounce];
    last_ = only >= 0 ? static_cast<uint32_t>(only) : settings[kBounces];
    first_shown_ = only >= 0 ? last_ : 1;
    shows_sky_ = wants_direct(settings);
    sweep_count_ = settings[kSweepDirections];
    voxel_count_ = settings[kVoxelCount];
    seed_ = settings[kSeed];
    transport_ = settings[kTransport];
    iterations_ = settings[kIterations];
    views_done_ = 0;
    sweeping_ = false;
    const auto step = [this](auto function, auto... which) {
        return [this, function, which...](Work& work) { return (this->*function)(work, which...); };
    };
    const bool sweeps = transport_ == Transport::sweeps;
    const size_t levels = basis_.focus.levels;
    std::vector<Step<Work>> steps = {{"surfels", step(&LightMaker::take_surfels)}};
    for (size_t level = 0; level < levels; ++level) {
        steps.push_back({"voxels", step(&LightMaker::divide, level)});
        steps.push_back({"faces", step(&LightMaker::find_faces, level)});
    }
    steps.push_back({"surfel light", step(&LightMaker::light_surfels)});
    steps.push_back({"face light", step(&LightMaker::light_faces)});
    steps.push_back({"sky", step(&LightMaker::sweep_sky)});
    for (size_t level = 0; sweeps && last_ > 0 && level < levels; ++level)
        steps.push_back({"first bounce", step(&LightMaker::gather_first, level)});
    for (uint32_t bounce = sweeps ? 2 : 1; bounce <= last_; ++bounce)
        steps.push_back(
            {"bounce", step(sweeps ? &LightMaker::sweep_bounce : &LightMaker::propagate_bounce, bounce)});
    runner_.start(std::move(steps));
}

bool LightMaker::goes_on(const Basis& now) const {
    return running() && basis_.cuts.light == now.cuts.light && basis_.scene.bounds == now.scene.bounds &&
           basis_.scene.settings == now.scene.settings;
}

Result<void> LightMaker::run(Frame& frame, const Inputs& inputs, const StepBudget& budget,
                             VolumeLight& target) {
    Work work{frame, inputs};
    LUCARNE_TRY(runner_.run(work, budget, frame.stop));
    if (runner_.running()) return {};
    target = {basis_, {}};
    for (const Level& level : levels_) target.levels.push_back({level.space, level.shown});
    return {};
}

/// Takes the surfels, and drops the levels that are made anew.
Result<StepResult> LightMaker::take_surfels(Work& work) {
    const SpaceBasis now{basis_.cuts.light, basis_.scene.bounds, voxel_count_};
    const bool same = surfels_of_ == now;
    if (same && focus_ == basis_.focus) return StepResult::skipped;
    const TimedPass pass(work.frame, "surfels");
    first_of_.reset();
    sweeper_.reset();
    propagation_.reset();
    levels_.resize(same ? std::min<size_t>(levels_.size(), 1) : 0);
    levels_.resize(basis_.focus.levels);
    focus_ = basis_.focus;
    if (same) return StepResult::done;
    surfels_of_.reset();
    surfels_lit_.reset();
    LUCARNE_TRY(surfels_.set_surfels(work.frame, Bare::of_planes));
    surfels_of_ = now;
    return StepResult::done;
}

Result<StepResult> LightMaker::divide(Work& work, size_t number) {
    Level& level = levels_[number];
    if (level.made) return StepResult::skipped;
    const TimedPass pass(work.frame, "voxels");
    if (!level.voxel_maker) {
        const auto surfels = surfels_.surfels();
        const Grid grid = number == 0 ? grid_about(surfels, voxel_count_)
                                      : finer_grid(levels_[number - 1].space->grid(), focus_.centre(number));
        level.face_maker.reset();
        level.voxel_maker.emplace(surfels, grid);
    }
    LUCARNE_ASSIGN(const bool more, level.voxel_maker->advance());
    if (more) return StepResult::again;
    level.space = std::make_shared<Space>();
    level.space->voxels = level.voxel_maker->finish();
    level.voxel_maker.reset();
    if (number + 1 == levels_.size() && level.space->grid().voxel > kWideVoxel)
        log::warn(
            "volume: voxels are wider than {:.0f} m, and light resolves nothing smaller; choose more "
            "(--voxels), or levels about the camera (--volume-levels)",
            kWideVoxel);
    return StepResult::done;
}

Result<StepResult> LightMaker::find_faces(Work& work, size_t number) {
    Level& level = levels_[number];
    if (level.made) return StepResult::skipped;
    const TimedPass pass(work.frame, "faces");
    if (!level.face_maker) level.face_maker.emplace(level.space->voxels, surfels_.surfels());
    if (level.face_maker->advance()) return StepResult::again;
    level.space->faces = level.face_maker->finish();
    level.face_maker.reset();
    level.space->air = Air(level.space->voxels, surfels_.surfels());
    level.first_bounce.emplace(*level.space);
    level.made = true;
    return StepResult::done;
}

Result<StepResult> LightMaker::light_surfels(Work& work) {
    if (surfels_lit_ == of_lights(basis_)) return StepResult::skipped;
    const TimedPass pass(work.frame, "surfel light");
    surfels_lit_.reset();
    first_of_.reset();
    if (views_done_ == 0) LUCARNE_TRY(surfels_.begin_light(work.frame));
    const auto& views = work.inputs.views;
    if (views_done_ < views.size())
        LUCARNE_TRY(surfels_.add_light(work.frame, views[views_done_++], work.inputs.gbuffers));
    if (views_done_ < views.size()) return StepResult::again;
    surfels_.end_light(work.frame);
    surfels_lit_ = of_lights(basis_);
    return StepResult::done;
}

Result<StepResult> LightMaker::light_faces(Work& work) {
    const TimedPass pass(work.frame, "surfel light");
    const auto own = surfels_.own_light();
    const auto reflectances = surfels_.reflectances();
    lit_faces_ = 0;
    for (Level& level : levels_) {
        if (level.own_of != surfels_lit_) {
            const Faces& faces = level.space->faces;
            level.own = faces.radiance_of<glm::vec3>(
                [&](uint32_t surfel, bool back) { return back ? own[surfel].back : own[surfel].front; });
            level.reflectances =
                faces.means<glm::vec3>([&](uint32_t surfel, bool) { return reflectances[surfel]; });
            level.own_of = surfels_lit_;
        }
        lit_faces_ += static_cast<size_t>(
            std::ranges::count_if(level.own, [](const glm::vec3& light) { return luminance(light) > 0; }));
        level.sources = level.own;
        level.shown.assign(level.own.size(), glm::vec3(0.0f));
    }
    return StepResult::done;
}

Directions LightMaker::directions(uint32_t bounce, uint32_t count) const {
    return even_directions(count, mix64(mix64(seed_, basis_.frame), bounce));
}

/// Begins to carry the sources of all levels, or only what comes from outside.
void LightMaker::begin_sweep(Directions directions, const Sweeper::Outside& outside, bool dark) {
    if (!sweeper_) {
        std::vector<const Space*> spaces;
        for (const Level& level : levels_) spaces.push_back(level.space.get());
        sweeper_.emplace(spaces);
    }
    std::vector<std::vector<glm::vec3>> none(levels_.size());
    std::vector<std::span<const glm::vec3>> radiance;
    for (size_t i = 0; i < levels_.size(); ++i) {
        if (dark) none[i].assign(levels_[i].sources.size(), glm::vec3(0.0f));
        radiance.emplace_back(dark ? none[i] : levels_[i].sources);
    }
    sweeper_->begin(std::move(directions), radiance, outside);
}

/// Adds the first reflection of the sky to the sources; pixels show it as direct light.
Result<StepResult> LightMaker::sweep_sky(Work& work) {
    const GatherSky& sky = work.inputs.sky;
    if (sky.texels.empty()) return StepResult::skipped;
    const TimedPass pass(work.frame, "sky");
    if (!sweeping_) {
        const uint32_t count = kSkyDirections * sweep_count_;
        begin_sweep(
            directions(0, count), [&sky, count](const glm::vec3& way) { return sky_about(sky, way, count); },
            true);
    }
    sweeping_ = sweeper_->advance();
    if (sweeping_) return StepResult::again;
    for (size_t i = 0; i < levels_.size(); ++i) {
        Level& level = levels_[i];
        const auto irradiance = smoothed(*level.space, sweeper_->irradiance(i));
        if (shows_sky_) level.shown = irradiance;
        add(level.sources, product(level.reflectances, irradiance));
    }
    return StepResult::done;
}

/// A level gathers from its own lit faces; what comes from beyond it, it takes from the level before it.
Result<StepResult> LightMaker::gather_first(Work& work, size_t number) {
    Level& level = levels_[number];
    // The sky's light differs in each frame, as its directions do.
    const Basis now = work.inputs.sky.texels.empty() ? without_frame(basis_) : basis_;
    if (first_of_ == now) {
        add_bounce(level, 1, level.first_light);
        return StepResult::skipped;
    }
    const TimedPass pass(work.frame, "first bounce");
    first_of_.reset();
    const bool last = number + 1 == levels_.size();
    if (!sweeping_)
        level.first_bounce->begin(level.sources, last ? nullptr : &levels_[number + 1].space->grid());
    sweeping_ = level.first_bounce->advance();
    if (sweeping_) return StepResult::again;
    level.first_light = smoothed(*level.space, level.first_bounce->irradiance());
    level.from_outside = smoothed(*level.space, level.first_bounce->from_outside());
    if (number > 0) {
        const Level& before = levels_[number - 1];
        const auto light = from_coarse(*before.space, before.from_outside, *level.space);
        add(level.first_light, light);
        add(level.from_outside, light);
    }
    add_bounce(level, 1, level.first_light);
    if (last) first_of_ = now;
    return StepResult::done;
}

Result<StepResult> LightMaker::sweep_bounce(Work& work, uint32_t bounce) {
    const TimedPass pass(work.frame, "sweep");
    if (!sweeping_)
        begin_sweep(
            directions(bounce, sweep_count_), [](const glm::vec3&) { return glm::vec3(0.0f); }, false);
    sweeping_ = sweeper_->advance();
    if (sweeping_) return StepResult::again;
    for (size_t i = 0; i < levels_.size(); ++i)
        add_bounce(levels_[i], bounce, smoothed(*levels_[i].space, sweeper_->irradiance(i)));
    return StepResult::done;
}

Result<StepResult> LightMaker::propagate_bounce(Work& work, uint32_t bounce) {
    const TimedPass pass(work.frame, "propagation");
    Level& level = levels_.front();
    if (level.space->grid().cells() > kMostLobes)
        return failed("volume", "so many voxels take too much memory with --transport sh",
                      "choose fewer (--voxels 64)");
    if (!propagation_) propagation_.emplace(*level.space);
    if (!sweeping_) {
        propagation_->begin(level.sources, iterations_);
        sent_ = luminance(propagation_->under_way());
    }
    sweeping_ = propagation_->advance();
    if (sweeping_) return StepResult::again;
    under_way_ = sent_ > 0 ? luminance(propagation_->under_way()) / sent_ : 0;
    add_bounce(level, bounce, propagation_->irradiance());
    return StepResult::done;
}

/// Takes over what a bounce brought to the faces: pixels show it if they should, and the next bounce carries
/// what is reflected.
void LightMaker::add_bounce(Level& level, uint32_t bounce, std::span<const glm::vec3> irradiance) const {
    if (bounce >= first_shown_) add(level.shown, irradiance);
    level.sources = product(level.reflectances, irradiance);
}

}  // namespace lucarne::gi::volume
