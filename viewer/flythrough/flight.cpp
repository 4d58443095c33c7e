#include "viewer/flythrough/flight.h"

#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "gi/compare/metrics.h"
#include "io/core/process.h"
#include "io/core/progress.h"
#include "io/files/file.h"
#include "viewer/frame/cost_model.h"
#include "viewer/frame/rgba.h"
#include "viewer/opening/first_view.h"

namespace lucarne::viewer {
namespace {

constexpr double kUsualFrameTime = 0.1;  ///< s, of a flight in real time without a target

/// A wall clock that can be paused.
class FlightClock {
 public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_ - paused_).count(); }
    template <class Work>
    auto while_stopped(const Work& work) {
        const auto before = Clock::now();
        auto result = work();
        paused_ += Clock::now() - before;
        return result;
    }

 private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    Clock::duration paused_{0};
};

std::vector<std::byte> shown(const Pipeline& pipeline, ImageSize size) {
    return pipeline.picture().download_all<std::byte>(size_t{size.width} * size.height * 4);
}

constexpr std::string_view kFramePrefix = "frame_";

std::filesystem::path frame_file(const std::filesystem::path& folder, size_t number) {
    return folder / fmt::format("{}{:05}.png", kFramePrefix, number);
}

Result<void> hand_over(const Pipeline& pipeline, const FlightOptions& options, size_t number) {
    const io::Image8 picture = without_alpha(shown(pipeline, options.size), options.size);
    if (options.frames_folder)
        LUCARNE_TRY(io::write_png(frame_file(*options.frames_folder, number), picture, options.overwrite));
    return options.take_frame ? options.take_frame(picture, number) : Result<void>();
}

/// Measures changes between consecutive frames. Keeps each frame for comparison with the next.
class Measures {
 public:
    explicit Measures(const FlightOptions& options) : options_(options) {}
    bool any() const { return options_.flicker || options_.changes; }
    /// Measures one frame. Always returns true, so that it can be called while the clock is paused.
    bool take(const Pipeline& pipeline, FlownFrame& frame) {
        if (options_.flicker) {
            SeenFrame now = seen_frame(pipeline);
            frame.luminance = gi::mean_luminance(now.radiance);
            if (seen_) frame.flicker = flicker_between(*seen_, now);
            seen_ = std::move(now);
        }
        if (options_.changes) {
            auto now = shown(pipeline, options_.size);
            if (!picture_.empty()) frame.change = change_between(picture_, now, options_.size);
            picture_ = std::move(now);
        }
        return true;
    }
    /// Call when the camera jumps: the next frame is not compared with the one before.
    void forget() {
        seen_.reset();
        picture_.clear();
    }

 private:
    const FlightOptions& options_;
    std::optional<SeenFrame> seen_;
    std::vector<std::byte> picture_;
};

/// The record of frames. When there are too many, keeps every second, fourth and so on, so that the record of
/// a long flight stays bounded.
class Record {
 public:
    void add(FlownFrame frame) {
        if (flown_++ % step_ == 0) frames.push_back(std::move(frame));
        if (frames.size() <= kLongestRecord) return;
        size_t kept = 0;
        for (size_t i = 0; i < frames.size(); i += 2) frames[kept++] = std::move(frames[i]);
        frames.resize(kept);
        step_ *= 2;
    }
    size_t flown() const { return flown_; }
    std::vector<FlownFrame> frames;

 private:
    size_t flown_ = 0, step_ = 1;
};

/// The budgets of cuts: fixed, or adapted to a frame-time target.
class Budgets {
 public:
    Budgets(Pipeline& pipeline, const FlightOptions& options)
        : pipeline_(pipeline),
          full_(pipeline.budgets()),
          target_(options.wait ? 0 : options.frame_time),
          size_(options.size),
          budget_(target_) {}
    ~Budgets() { pipeline_.set_budgets(full_); }
    Budgets(const Budgets&) = delete;
    Budgets& operator=(const Budgets&) = delete;
    void observe(const FrameStats& stats) {
        if (!(target_ > 0)) return;
        budget_.observe(stats, size_);
        const CutBudgets next = budget_.budgets(full_);
        if (!(next == pipeline_.budgets())) pipeline_.set_budgets(next);
    }

 private:
    Pipeline& pipeline_;
    const CutBudgets full_;
    double target_;
    ImageSize size_;
    FrameBudget budget_;
};

/// The state that a flight carries from frame to frame.
struct Flying {
    Pipeline& pipeline;
    const CameraPath& path;
    const FlightOptions& options;
    Progress progress;
    FlightClock clock{};
    Measures measures{options};
    Budgets budgets{pipeline, options};
    Record record{};
    gi::Scene scene = options.scene;  ///< as the lights are now

    /// Flies once along the path.
    Result<void> lap(size_t number) {
        const double began = clock.seconds();
        measures.forget();
        size_t frame_of_lap = 0;
        for (bool last = false; !last; ++frame_of_lap) {
            const double since_start = options.wait
                                           ? static_cast<double>(frame_of_lap) / path.frames_per_second
                                           : std::min(clock.seconds() - began, path.duration());
            // In real time the last frame is the one at the path's end.
            last = options.wait ? frame_of_lap + 1 >= path.frames() : since_start >= path.duration();
            LUCARNE_TRY(draw(path.start() + since_start, number));
        }
        return {};
    }

    gi::StepBudget light_budget() const {
        if (options.light_seconds) return gi::StepBudget::timed(*options.light_seconds);
        if (options.wait) return {};
        return gi::StepBudget::timed(kLightShare *
                                     (options.frame_time > 0 ? options.frame_time : kUsualFrameTime));
    }

    Result<void> draw(double time, size_t lap) {
        if (!path.lights.empty()) {
            path.lights.apply(options.scene, time, scene);
            LUCARNE_TRY(pipeline.set_scene(scene));
        }
        FrameRequest request;
        request.camera = path.at(time);
        request.size = options.size;
        request.wait = options.wait;
        request.moving = true;
        request.front_only = options.site && looks_in_from_outside(*options.site, request.camera);
        request.light_budget = light_budget();
        FlownFrame frame;
        frame.time = time;
        frame.lap = lap;
        LUCARNE_ASSIGN(frame.stats, pipeline.render(request));
        frame.wall = clock.seconds();
        if (measures.any()) clock.while_stopped([&] { return measures.take(pipeline, frame); });
        budgets.observe(frame.stats);
        record.add(std::move(frame));
        progress.add(1);
        if (!options.frames_folder && !options.take_frame) return {};
        return clock.while_stopped([&] { return hand_over(pipeline, options, record.flown()); });
    }
};

MemoryUse memory_now(const Record& record) {
    MemoryUse use = record.frames.back().stats.memory;
    use.resident = resident_memory();
    return use;
}

}  // namespace

Result<void> prepare_frames_folder(const std::filesystem::path& folder, bool overwrite) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return failed(folder.string(), error.message(), "name a folder that can be written");
    if (overwrite) return {};
    // Frames of another flight would be mixed with this flight's frames.
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with(kFramePrefix) && name.ends_with(".png"))
            return check_output(entry->path(), false);
    }
    if (error) return failed(folder.string(), error.message());
    return {};
}

Result<Flight> fly(Pipeline& pipeline, const CameraPath& path, const FlightOptions& options) {
    LUCARNE_TRY(path.lights.check(options.scene));
    const bool known_length = options.wait && options.soak == 0;
    Flying flying{pipeline, path, options,
                  Progress(options.wait ? "flying" : "flying in real time", known_length ? path.frames() : 0,
                           "frames")};
    Flight flight;
    LUCARNE_TRY(flying.lap(0));
    if (options.soak > 0) {
        Soak soak;
        soak.first = memory_now(flying.record);
        for (soak.laps = 1; flying.clock.seconds() < options.soak; ++soak.laps)
            LUCARNE_TRY(flying.lap(soak.laps));
        soak.last = memory_now(flying.record);
        soak.frames = flying.record.flown();
        flight.soak = soak;
    }
    flight.wall_seconds = flying.clock.seconds();
    flight.frames = std::move(flying.record.frames);
    return flight;
}

}  // namespace lucarne::viewer
