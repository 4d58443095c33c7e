// A scan in a pipeline of its own, as in the viewer, for benchmarks that draw many pictures of it.
#pragma once

#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/bounce_options.h"
#include "gi/compare/edges.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "tests/bench/quantile.h"
#include "tests/bench/scan.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/frame/rgba.h"
#include "viewer/inputs/input.h"

namespace lucarne::bench {

/// Returns one of the engine's statistics of a frame; 0 if it has none of this name.
inline double statistic(const viewer::FrameStats& stats, std::string_view name) {
    for (const auto& [key, value] : stats.engine)
        if (key == name) return value;
    return 0;
}
/// Returns how long the passes of this name took.
inline double pass_seconds(const viewer::FrameStats& stats, std::string_view name) {
    double seconds = 0;
    for (const auto& pass : stats.passes)
        if (pass.name == name) seconds += pass.seconds;
    return seconds;
}

class Stage {
 public:
    Stage(gi::Device& device, const Scan& scan) : device_(device), scan_(scan) {}

    struct View {
        std::string scene;  ///< path of its file
        ImageSize size;
        std::string preset = std::string(viewer::kDefaultPreset);
        std::string camera = "";  ///< empty: the first
    };
    Result<void> open(const View& view) {
        pipeline_.reset();  // its memory is needed for the next one
        LUCARNE_ASSIGN(const auto source, viewer::open_input(scan_.cache()));
        viewer::DrawingOptions options;
        options.scene = view.scene;
        options.render.preset = view.preset;
        LUCARNE_TRY(viewer::take_render_settings(options));
        LUCARNE_ASSIGN(const viewer::Drawing drawing, viewer::resolve(options));
        LUCARNE_ASSIGN(const viewer::SceneForScan made, viewer::load_scene_for(options, *source));
        const gi::Scene& loaded = made.scene;
        LUCARNE_ASSIGN(request_.camera, viewer::find_camera(loaded, view.camera));
        request_.size = view.size;
        request_.wait = true;
        request_.antialiased = false;  // as the reference's pictures
        LUCARNE_ASSIGN(pipeline_, viewer::open_pipeline(device_, source, options, drawing, loaded));
        return {};
    }

    struct Measured {
        double milliseconds = 0;  ///< median
        double processor = 0;     ///< time of all cores, ms: median
        double luminance = 0;     ///< mean over pixels and frames
        viewer::FrameStats last;
    };
    /// Draws frames that share nothing: each has other VPLs, but every call uses the same ones.
    Result<Measured> frames(gi::EngineSettings settings, int count) {
        return frames_after(count, [&](int i) -> Result<void> {
            settings.set(gi::kSeed, 1 + static_cast<uint64_t>(i));
            pipeline_->set_settings(settings);
            return {};
        });
    }
    /// Draws frames, each after change(index), which may change pipeline() and request().
    Result<Measured> frames_after(int count, const std::function<Result<void>(int)>& change) {
        Measured measured;
        std::vector<double> times, processor;
        for (int i = 0; i < count; ++i) {
            LUCARNE_TRY(change(i));
            const std::clock_t start = std::clock();
            LUCARNE_ASSIGN(measured.last, pipeline_->render(request_));
            processor.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
            times.push_back(1e3 * measured.last.seconds);
            measured.luminance += gi::mean_luminance(radiance()) / count;
        }
        measured.milliseconds = median(times);
        measured.processor = median(processor);
        return measured;
    }

    struct Picture {
        std::vector<glm::vec4> pixels;  ///< radiance
        double seconds = 0, cpu_seconds = 0;
        viewer::FrameStats last;
    };
    /// Averages frames of an engine that has computed nothing before.
    Result<Picture> picture(std::string_view engine, const gi::EngineSettings& settings,
                            uint64_t frames = 1) {
        LUCARNE_TRY(pipeline_->set_engine(engine));
        pipeline_->set_settings(settings);
        request_.accumulate = frames > 1;
        Picture picture;
        const std::clock_t start = std::clock();
        for (uint64_t i = 0; i < frames; ++i) {
            LUCARNE_ASSIGN(picture.last, pipeline_->render(request_));
            picture.seconds += picture.last.seconds;
        }
        request_.accumulate = false;
        picture.cpu_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        if (picture.last.accumulated != frames) return failed("average", "lacks frames");
        picture.pixels = radiance();
        return picture;
    }
    /// Returns what the reference makes of the points of this stage's preset.
    Result<Scan::Truth> truth(gi::EngineSettings settings, uint64_t samples) {
        settings.set(gi::reference::kSamples, static_cast<uint32_t>(samples));
        LUCARNE_ASSIGN(Picture whole, picture("reference", settings));
        auto layers = pipeline_->layers();
        return Scan::Truth{std::move(whole.pixels), std::move(layers.at(1)), std::move(layers.at(2))};
    }

    /// Returns the normals and depths of the last picture.
    io::Image gbuffer() const { return gi::gbuffer_image(pipeline_->gbuffer()); }

    /// Writes the last frame, tone-mapped.
    Result<void> write(const std::filesystem::path& path) const {
        const auto rgba = pipeline_->picture().download_all<uint32_t>(pixels());
        return io::write_png(path, viewer::without_alpha(std::as_bytes(std::span(rgba)), request_.size),
                             true);
    }

    gi::EngineSettings settings() const { return pipeline_->settings(); }
    viewer::Pipeline& pipeline() { return *pipeline_; }
    viewer::FrameRequest& request() { return request_; }

 private:
    size_t pixels() const { return size_t{request_.size.width} * request_.size.height; }
    std::vector<glm::vec4> radiance() const {
        return pipeline_->radiance().download_all<glm::vec4>(pixels());
    }

    gi::Device& device_;
    const Scan& scan_;
    viewer::FrameRequest request_;
    std::unique_ptr<viewer::Pipeline> pipeline_;
};

}  // namespace lucarne::bench
