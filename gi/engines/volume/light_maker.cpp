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
#include "io/core/random.h"

namespace lucarne::gi::volume {
namespace {

/// Voxels of transport sh: their lobes take 128 bytes each.
constexpr size_t kMostLobes = size_t{1} << 19;
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
    const auto step = [this](auto function) {
        return [this, function](Work& work) { return (this->*function)(work); };
    };
    std::vector<Step<Work>> steps = {{"surfels", step(&LightMaker::take_surfels)},
                                     {"voxels", step(&LightMaker::divide)},
                                     {"faces", step(&LightMaker::find_faces)},
                                     {"surfel light", step(&LightMaker::light_surfels)},
                                     {"sky", step(&LightMaker::sweep_sky)}};
    const bool sweeps = transport_ == Transport::sweeps;
    if (sweeps && last_ > 0) steps.push_back({"first bounce", step(&LightMaker::gather_first)});
    for (uint32_t bounce = sweeps ? 2 : 1; bounce <= last_; ++bounce)
        steps.push_back({"bounce", [this, bounce, sweeps](Work& work) {
                             return sweeps ? sweep_bounce(work, bounce) : propagate_bounce(work, bounce);
                         }});
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
    target = {basis_, space_, shown_};
    return {};
}

Result<StepResult> LightMaker::take_surfels(Work& work) {
    const SpaceBasis now{basis_.cuts.light, basis_.scene.bounds, voxel_count_};
    if (space_of_ == now) return StepResult::skipped;
    const TimedPass pass(work.frame, "surfels");
    space_of_.reset();
    own_of_.reset();
    first_of_.reset();
    sweeper_.reset();
    first_bounce_.reset();
    propagation_.reset();
    voxel_maker_.reset();
    face_maker_.reset();
    LUCARNE_TRY(surfels_.set_surfels(work.frame));
    return StepResult::done;
}

Result<StepResult> LightMaker::divide(Work& work) {
    if (space_of_) return StepResult::skipped;
    const TimedPass pass(work.frame, "voxels");
    if (!voxel_maker_) {
        const auto surfels = surfels_.surfels();
        voxel_maker_.emplace(surfels, grid_about(surfels, voxel_count_));
    }
    LUCARNE_ASSIGN(const bool more, voxel_maker_->advance());
    if (more) return StepResult::again;
    space_ = std::make_shared<Space>();
    space_->voxels = voxel_maker_->finish();
    voxel_maker_.reset();
    return StepResult::done;
}

Result<StepResult> LightMaker::find_faces(Work& work) {
    if (space_of_) return StepResult::skipped;
    const TimedPass pass(work.frame, "faces");
    if (!face_maker_) face_maker_.emplace(space_->voxels, surfels_.surfels());
    if (face_maker_->advance()) return StepResult::again;
    space_->faces = face_maker_->finish();
    face_maker_.reset();
    space_->air = Air(space_->voxels);
    sweeper_.emplace(*space_);
    first_bounce_.emplace(*space_);
    space_of_ = SpaceBasis{basis_.cuts.light, basis_.scene.bounds, voxel_count_};
    return StepResult::done;
}

Result<StepResult> LightMaker::light_surfels(Work& work) {
    if (own_of_ == without_frame(basis_)) {
        sources_ = own_;
        shown_.assign(own_.size(), glm::vec3(0.0f));
        return StepResult::skipped;
    }
    const TimedPass pass(work.frame, "surfel light");
    own_of_.reset();
    first_of_.reset();
    if (views_done_ == 0) LUCARNE_TRY(surfels_.begin_light(work.frame));
    const auto& views = work.inputs.views;
    if (views_done_ < views.size())
        LUCARNE_TRY(surfels_.add_light(work.frame, views[views_done_++], work.inputs.gbuffers));
    if (views_done_ < views.size()) return StepResult::again;
    surfels_.end_light(work.frame);
    light_faces();
    own_of_ = without_frame(basis_);
    return StepResult::done;
}

void LightMaker::light_faces() {
    const auto own = surfels_.own_light();
    const auto reflectances = surfels_.reflectances();
    own_ = space_->faces.means<glm::vec3>(
        [&](uint32_t surfel, bool back) { return back ? own[surfel].back : own[surfel].front; });
    reflectances_ =
        space_->faces.means<glm::vec3>([&](uint32_t surfel, bool) { return reflectances[surfel]; });
    lit_faces_ = static_cast<size_t>(
        std::ranges::count_if(own_, [](const glm::vec3& light) { return luminance(light) > 0; }));
    sources_ = own_;
    shown_.assign(own_.size(), glm::vec3(0.0f));
}

Directions LightMaker::directions(uint32_t bounce) const {
    return even_directions(sweep_count_, mix64(mix64(seed_, basis_.frame), bounce));
}

/// Adds the first reflection of the sky to the sources; pixels show it as direct light.
Result<StepResult> LightMaker::sweep_sky(Work& work) {
    const GatherSky& sky = work.inputs.sky;
    if (sky.texels.empty()) return StepResult::skipped;
    const TimedPass pass(work.frame, "sky");
    if (!sweeping_) {
        const std::vector<glm::vec3> dark(space_->faces.all().size(), glm::vec3(0.0f));
        sweeper_->begin(directions(0), dark, [&sky, count = sweep_count_](const glm::vec3& way) {
            return sky_about(sky, way, count);
        });
    }
    sweeping_ = sweeper_->advance();
    if (sweeping_) return StepResult::again;
    const auto irradiance = smoothed(*space_, sweeper_->irradiance());
    if (shows_sky_) shown_ = irradiance;
    const auto light = reflected(irradiance);
    for (size_t face = 0; face < sources_.size(); ++face) sources_[face] += light[face];
    return StepResult::done;
}

Result<StepResult> LightMaker::gather_first(Work& work) {
    // The sky's light differs in each frame, as its directions do.
    const Basis now = work.inputs.sky.texels.empty() ? without_frame(basis_) : basis_;
    if (first_of_ == now) {
        add_bounce(1, first_light_);
        return StepResult::skipped;
    }
    const TimedPass pass(work.frame, "first bounce");
    first_of_.reset();
    if (!sweeping_) first_bounce_->begin(sources_);
    sweeping_ = first_bounce_->advance();
    if (sweeping_) return StepResult::again;
    first_light_ = smoothed(*space_, first_bounce_->irradiance());
    add_bounce(1, first_light_);
    first_of_ = now;
    return StepResult::done;
}

Result<StepResult> LightMaker::sweep_bounce(Work& work, uint32_t bounce) {
    const TimedPass pass(work.frame, "sweep");
    if (!sweeping_)
        sweeper_->begin(directions(bounce), sources_, [](const glm::vec3&) { return glm::vec3(0.0f); });
    sweeping_ = sweeper_->advance();
    if (sweeping_) return StepResult::again;
    add_bounce(bounce, smoothed(*space_, sweeper_->irradiance()));
    return StepResult::done;
}

Result<StepResult> LightMaker::propagate_bounce(Work& work, uint32_t bounce) {
    const TimedPass pass(work.frame, "propagation");
    if (space_->grid().cells() > kMostLobes)
        return failed("volume", "so many voxels take too much memory with --transport sh",
                      "choose fewer (--voxels 64)");
    if (!propagation_) propagation_.emplace(*space_);
    if (!sweeping_) {
        propagation_->begin(sources_, iterations_);
        sent_ = luminance(propagation_->under_way());
    }
    sweeping_ = propagation_->advance();
    if (sweeping_) return StepResult::again;
    under_way_ = sent_ > 0 ? luminance(propagation_->under_way()) / sent_ : 0;
    add_bounce(bounce, propagation_->irradiance());
    return StepResult::done;
}

/// Takes over what a bounce brought to the faces: pixels show it if they should, and the next bounce carries
/// what is reflected.
void LightMaker::add_bounce(uint32_t bounce, std::span<const glm::vec3> irradiance) {
    if (bounce >= first_shown_)
        for (size_t face = 0; face < irradiance.size(); ++face) shown_[face] += irradiance[face];
    sources_ = reflected(irradiance);
}

std::vector<glm::vec3> LightMaker::reflected(std::span<const glm::vec3> irradiance) const {
    std::vector<glm::vec3> light(irradiance.size());
    for (size_t face = 0; face < light.size(); ++face) light[face] = reflectances_[face] * irradiance[face];
    return light;
}

}  // namespace lucarne::gi::volume
