#include "gi/engines/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/reference/path_tracer.h"
#include "gi/host_frame.h"
#include "gi/surfels/plane_normals.h"
#include "io/core/log.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

using reference::PathSettings;
using reference::PathSums;
using reference::PathTracer;
using reference::Start;
using tracing::Illumination;
using tracing::SurfelTracer;

/// Returns the radiance of a pixel without a surface.
vec3 background(const Frame& frame, const Start& start) {
    return frame.environment ? frame.environment->radiance(-start.viewer) : frame.background;
}

constexpr const OptionInfo* kOptions[] = {&kBounces.info, &kOnlyBounce.info, &reference::kSamples.info,
                                          &kSeed.info};
constexpr std::string_view kLayers[] = {"stderr", "a", "b"};
constexpr EngineInfo kInfo{.name = "reference",
                           .label = "Path tracer",
                           .description = "path tracing over the same surfels: slow, and the truth",
                           .options = kOptions,
                           .needs = {.light_cut = true},
                           .layers = kLayers,
                           .reports_progress = true,
                           .is_reference = true};

class ReferenceEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override;
    std::vector<std::vector<glm::vec4>> layers() const override;

 protected:
    void update(const Changes& changes) override;
    Result<void> prepare(Frame& frame) override;
    Result<void> render(Frame& frame) override;

 private:
    void take_in(const Frame& frame, std::vector<PathSums> sums);

    std::unique_ptr<SurfelTracer> tracer_;
    std::unique_ptr<Illumination> illumination_;
    SceneRevisions scene_;    // of the last frame
    uint64_t light_cut_ = 0;  // likewise
    double coverage_ = 0;

    std::vector<PathSums> sums_;  // of all frames since the view changed
    uint64_t next_frame_ = 0;
    reference::MeanLuminance mean_;  // of the last frame
    uint32_t samples_ = 0;
};

/// Drops the tree and the sampling tables where what they are made from has changed.
void ReferenceEngine::update(const Changes& changes) {
    const SceneRevisions& now = changes.scene;
    if (changes.light_cuts.light != light_cut_ || now.lights != scene_.lights ||
        now.materials != scene_.materials || now.environment != scene_.environment)
        illumination_.reset();
    if (changes.light_cuts.light != light_cut_) tracer_.reset();
    scene_ = now;
    light_cut_ = changes.light_cuts.light;
}

Result<void> ReferenceEngine::prepare(Frame& frame) {
    const TimedPass pass(frame, "surfels for tracing");
    if (!tracer_) {
        std::vector<Surfel> surfels = download_light_surfels(frame);
        add_normals_of_planes(surfels);  // of a scan that is being read: its walls would let light through
        LUCARNE_ASSIGN(tracer_, SurfelTracer::create(std::move(surfels)));
        coverage_ = tracer_->coverage();
        log::info("reference: {} surfels, coverage {:.2f}", tracer_->surfels().size(), coverage_);
    }
    if (!illumination_)
        illumination_ =
            std::make_unique<Illumination>(*tracer_, frame.materials, frame.lights, frame.environment);
    return {};
}

/// Adds a frame to the sums so far, or starts them again.
void ReferenceEngine::take_in(const Frame& frame, std::vector<PathSums> sums) {
    const bool goes_on = frame.index > 0 && frame.index == next_frame_ && sums_.size() == sums.size();
    next_frame_ = frame.index + 1;
    if (!goes_on) {
        sums_ = std::move(sums);
        return;
    }
    for (size_t i = 0; i < sums.size(); ++i) sums_[i].add(sums[i]);
}

Result<void> ReferenceEngine::render(Frame& frame) {
    const TimedPass pass(frame, "paths");
    const auto starts = visible_surfaces(frame.camera, download_gbuffer(frame));
    const size_t pixels = starts.size();
    const PathSettings settings{.bounces = frame.settings[kBounces],
                                .only_bounce = frame.settings[kOnlyBounce],
                                .samples = frame.settings[reference::kSamples],
                                .seed = frame.settings[kSeed],
                                .frame = frame.index};
    std::vector<PathSums> sums =
        PathTracer(*illumination_, settings).trace(starts, frame.progress, frame.stop);
    if (frame.stopped()) return {};
    const bool seen_directly = frame.settings[kOnlyBounce] <= 0;
    for (size_t i = 0; i < pixels; ++i)
        if (!(starts[i].radius > 0) && seen_directly)
            sums[i].exact = glm::dvec3(background(frame, starts[i]));
    std::vector<vec4> radiance(pixels);
    for (size_t i = 0; i < pixels; ++i) radiance[i] = vec4(sums[i].radiance(), 1.0f);
    upload_radiance(frame, radiance);
    mean_ = reference::mean_luminance(sums);
    samples_ = settings.samples;
    take_in(frame, std::move(sums));
    return {};
}

std::vector<std::pair<std::string, double>> ReferenceEngine::stats() const {
    return {{"samples", samples_},
            {"surfels traced", tracer_ ? static_cast<double>(tracer_->surfels().size()) : 0},
            {"coverage", coverage_},
            {"mean luminance", mean_.mean},
            {"standard error", mean_.standard_error}};
}

/// Returns the standard error of each pixel's luminance, and the radiance of each half of the paths.
std::vector<std::vector<glm::vec4>> ReferenceEngine::layers() const {
    std::vector<std::vector<glm::vec4>> layers(info().layers.size());
    for (const PathSums& sums : sums_) {
        layers[0].emplace_back(glm::vec3(std::sqrt(sums.variance())), 1.0f);
        layers[1].emplace_back(sums.half_radiance(0), 1.0f);
        layers[2].emplace_back(sums.half_radiance(1), 1.0f);
    }
    return layers;
}

}  // namespace

EngineEntry reference_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<ReferenceEngine>(); }};
}

}  // namespace lucarne::gi
