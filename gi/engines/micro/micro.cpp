#include "gi/engines/micro/micro.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "gi/bounce_options.h"
#include "gi/gather/final_gather.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/tree_lighting.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/light_options.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace micro {
namespace {

constexpr const OptionInfo* kOptions[] = {
    &kBounces.info,      &kOnlyBounce.info, &kMicroBuffer.info, &kGatherEvery.info, &kRadiosityLevel.info,
    &kLightPoints.info,  &kPhotons.info,    &kVpls.info,        &kShadows.info,     &kLightResolution.info,
    &kLightSamples.info, &kFill.info,       &kWarp.info,        &kSeed.info};
constexpr EngineInfo kInfo{.name = "micro",
                           .label = "Final gathering",
                           .description = "final gathering of the light of all surfels, on OpenCL",
                           .options = kOptions,
                           .needs = {.light_cut = true, .light_views = true, .opencl = true},
                           .reports_progress = true};

constexpr uint32_t kLargestRadiositySide = 16;

class MicroEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;

 protected:
    void update(const Changes& changes) override { lighting_.update(changes); }
    Result<void> prepare(Frame& frame) override { return lighting_.prepare(frame, kInfo.name); }
    Result<void> render(Frame& frame) override;

 private:
    Result<void> gather(Frame& frame);

    TreeLighting lighting_;
    GatherCounts counts_;
};

/// Sets the picture to what pixels reflect of the light of surfels and of the sky.
Result<void> MicroEngine::gather(Frame& frame) {
    const EngineSettings& s = frame.settings;
    LUCARNE_TRY(lighting_.make_tree(frame));
    if (wants_indirect(s)) {
        const bool only = s[kOnlyBounce] >= 0;
        LUCARNE_TRY(
            lighting_.make_light(frame,
                                 {.bounces = (only ? static_cast<uint32_t>(s[kOnlyBounce]) : s[kBounces]) - 1,
                                  .sky = lighting_.has_sky(),
                                  .only_last = only,
                                  .side = std::min(s[kMicroBuffer], kLargestRadiositySide),
                                  .seed = mix64(s[kSeed], frame.index)},
                                 s[kLightPoints]));
    }
    if (frame.stopped()) return {};
    const Gathered what = !wants_indirect(s)                       ? Gathered::sky
                          : wants_direct(s) && lighting_.has_sky() ? Gathered::both
                                                                   : Gathered::light_of_surfels;
    RareLight rare;
    if (wants_indirect(s))
        rare.find_bright = [this, &frame, what](std::span<const GatherPoint> pilots, uint64_t seed) {
            return lighting_.find_bright(frame, pilots, what, seed);
        };
    if (what != Gathered::light_of_surfels)
        rare.find_openings = [this, &frame](std::span<const GatherPoint> pilots, uint64_t seed) {
            return lighting_.find_openings(frame, pilots, seed);
        };
    LUCARNE_ASSIGN(const std::vector<glm::vec4> light,
                   gather_pixels(frame, lighting_.opencl(), lighting_.gatherer(), what, rare,
                                 {s[kFill], s[kWarp]}, counts_));
    if (!frame.stopped()) upload_radiance(frame, light);
    return {};
}

Result<void> MicroEngine::render(Frame& frame) {
    lighting_.begin(frame);
    frame.gl.radiance.clear(0);
    counts_ = {};
    const bool direct = wants_direct(frame.settings);
    if (wants_indirect(frame.settings) || (direct && lighting_.has_sky())) LUCARNE_TRY(gather(frame));
    if (frame.stopped() || !direct) return {};
    return lighting_.add_direct(frame);
}

std::vector<std::pair<std::string, double>> MicroEngine::stats() const {
    return {{"tree_nodes", lighting_.lit().tree().nodes.size()},
            {"surfels", lighting_.lit().tree().leaves},
            {"radiosity_places", lighting_.radiosity().places()},
            {"gather_points", counts_.points},
            {"gathered_again", counts_.again}};
}

}  // namespace
}  // namespace micro

EngineEntry micro_engine() {
    return {micro::kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<micro::MicroEngine>(); }};
}

}  // namespace lucarne::gi
