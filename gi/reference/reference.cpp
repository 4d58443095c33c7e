#include "gi/reference/reference.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/packing.hpp>
#include <xxhash.h>

#include "gi/reference/path_tracer.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

using reference::Estimate;
using reference::PathSettings;
using reference::PathTracer;
using reference::Start;
using reference::SurfelTracer;

/// The surfaces that the camera sees, as every engine gets them: the reference differs from the others in
/// transport alone, not in what is visible.
std::vector<Start> starts_of(const CameraView& camera, std::span<const GBufferTexel> texels) {
    std::vector<Start> starts(texels.size());
    const vec3 forward(camera.forward), right(camera.right), up(camera.up), eye(camera.origin);
    parallel_ranges(texels.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const GBufferTexel& texel = texels[i];
            if (!(texel.depth > 0)) continue;
            const float x = (static_cast<float>(i % camera.width) + .5f) / static_cast<float>(camera.width);
            const float y = (static_cast<float>(i / camera.width) + .5f) / static_cast<float>(camera.height);
            const vec3 ray = forward + right * (2 * x - 1) - up * (2 * y - 1);
            Start& start = starts[i];
            start.position = eye + texel.depth * ray;
            start.normal = decode_octahedral(texel.normal);
            start.viewer = -glm::normalize(ray);
            start.albedo = decode_albedo(texel.albedo);
            // A half float may have become 0 or infinite: there is a surface all the same.
            start.radius = std::clamp(glm::unpackHalf2x16(texel.material).y, 1e-7f, 65504.0f);
            start.material = texel.material & 0xffffu;
        }
    });
    return starts;
}

class ReferenceEngine final : public Engine {
 public:
    const EngineInfo& info() const override {
        static const EngineInfo info{"reference", "path tracing over the same surfels: slow, and the truth"};
        return info;
    }

    Result<void> prepare(Frame& frame) override {
        if (!frame.cuts.light) return failed("reference", "there is no light cut to trace");
        frame.times.begin("surfels for tracing");
        std::vector<Surfel> surfels = frame.pool.download(*frame.cuts.light);
        const uint64_t content = XXH3_64bits(surfels.data(), surfels.size() * sizeof(Surfel));
        if (!tracer_ || content != content_) {
            tracer_.reset();  // two trees at once would double the peak
            LUCARNE_ASSIGN(tracer_, SurfelTracer::create(std::move(surfels)));
            content_ = content;
        }
        frame.times.end();
        return {};
    }

    Result<void> render(Frame& frame) override {
        if (!tracer_) return failed("reference", "a frame was rendered before it was prepared");
        frame.times.begin("paths");
        const size_t pixels = size_t{frame.gbuffer.width} * frame.gbuffer.height;
        const auto starts = starts_of(frame.camera, frame.gbuffer.texels.download_all<GBufferTexel>(pixels));
        const PathSettings settings{.bounces = frame.settings.bounces,
                                    .only_bounce = frame.settings.only_bounce,
                                    .samples = frame.settings.samples,
                                    .seed = frame.settings.seed,
                                    .frame = frame.index};
        const PathTracer paths(*tracer_, frame.lights, frame.materials, settings);
        const std::vector<Estimate> estimates = paths.trace(starts);
        const vec3 background = frame.settings.only_bounce > 0 ? vec3(0.0f) : frame.background;
        std::vector<vec4> radiance(pixels);
        for (size_t i = 0; i < pixels; ++i)
            radiance[i] = vec4(starts[i].radius > 0 ? estimates[i].radiance : background, 1.0f);
        frame.radiance.upload_all(radiance);
        mean_ = reference::mean_luminance(estimates);
        samples_ = settings.samples;
        frame.times.end();
        return {};
    }

    std::vector<std::pair<std::string, double>> stats() const override {
        return {{"samples", samples_},
                {"surfels traced", tracer_ ? static_cast<double>(tracer_->surfels().size()) : 0},
                {"mean luminance", mean_.mean},
                {"standard error", mean_.standard_error}};
    }

 private:
    std::unique_ptr<SurfelTracer> tracer_;
    uint64_t content_ = 0;  // hash of the surfels that tracer_ was built from
    reference::MeanLuminance mean_;
    uint32_t samples_ = 0;
};

}  // namespace

std::unique_ptr<Engine> make_reference_engine() {
    return std::make_unique<ReferenceEngine>();
}

}  // namespace lucarne::gi
