#include "viewer/flythrough/flight.h"

#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "gi/compare/metrics.h"
#include "io/core/progress.h"
#include "viewer/rgba.h"

namespace lucarne::viewer {
namespace {

/// Wall clock that can stand still.
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

Result<void> write_frame(const Pipeline& pipeline, const FlightOptions& options, size_t number) {
    const size_t bytes = size_t{options.size.width} * options.size.height * 4;
    const auto rgba = pipeline.picture().download_all<std::byte>(bytes);
    return io::write_png(*options.frames_folder / fmt::format("frame_{:05}.png", number),
                         without_alpha(rgba, options.size), options.overwrite);
}

/// The light of a frame, and against that of the frame before, which it becomes.
bool measure(const Pipeline& pipeline, std::optional<SeenFrame>& before, FlownFrame& frame) {
    SeenFrame now = seen_frame(pipeline);
    frame.luminance = gi::mean_luminance(now.radiance);
    if (before) frame.flicker = flicker_between(*before, now);
    before = std::move(now);
    return true;
}

}  // namespace

Result<Flight> fly(Pipeline& pipeline, const CameraPath& path, const FlightOptions& options) {
    Flight flight;
    Progress progress(options.wait ? "flying" : "flying by the clock", options.wait ? path.frames() : 0,
                      "frames");
    FlightClock clock;
    std::optional<SeenFrame> before;
    for (bool last = false; !last;) {
        const double since_start = options.wait
                                       ? static_cast<double>(flight.frames.size()) / path.frames_per_second
                                       : std::min(clock.seconds(), path.duration());
        // By the clock the last frame is the one at the path's end.
        last = options.wait ? flight.frames.size() + 1 >= path.frames() : since_start >= path.duration();
        FrameRequest request;
        request.camera = path.at(path.start() + since_start);
        request.size = options.size;
        request.wait = options.wait;
        request.moving = true;
        FlownFrame frame{path.start() + since_start, {}, {}, {}};
        LUCARNE_ASSIGN(frame.stats, pipeline.render(request));
        if (options.flicker) clock.while_stopped([&] { return measure(pipeline, before, frame); });
        flight.frames.push_back(std::move(frame));
        progress.add(1);
        if (options.frames_folder)
            LUCARNE_TRY(
                clock.while_stopped([&] { return write_frame(pipeline, options, flight.frames.size()); }));
    }
    flight.wall_seconds = clock.seconds();
    return flight;
}

}  // namespace lucarne::viewer
