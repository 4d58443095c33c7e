#include "viewer/publish/render_worker.h"

#include <atomic>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "io/core/job_queue.h"
#include "io/files/file.h"
#include "viewer/flythrough/flight.h"
#include "viewer/flythrough/video.h"

namespace lucarne::viewer {

struct RenderWorker::State {
    std::function<void()> changed;
    std::atomic<bool> stop{false};
    std::mutex mutex;
    RenderState shown;
    std::optional<Result<std::string>> outcome;
    JobQueue jobs;  ///< the last member: it ends before what its jobs use

    Result<void> frame_done();
    void finish(Result<std::string> done);
    Result<std::string> render(const RenderOrder& order, const WorkerDevice& device);
    Result<std::string> draw(const RenderOrder& order, const WorkerDevice& device);
    Result<std::string> still(Pipeline& pipeline, const RenderOrder& order, const StillOrder& what);
    Result<std::string> flight(Pipeline& pipeline, const RenderOrder& order, const FlightOrder& what);
};

namespace {

constexpr const char* kCancelled = "cancelled";

/// Checks an order before the long work.
Result<void> check(const RenderOrder& order) {
    if (const auto* still = std::get_if<StillOrder>(&order.what)) {
        const auto extension = still->file.extension();
        if (extension != ".png" && extension != ".PNG")
            return bad_arguments(still->file.string(), "is not named .png", "name it .png");
        return check_output(still->file, false);
    }
    const auto& flight = std::get<FlightOrder>(order.what);
    if (flight.path.keys.empty()) return failed("flythrough", "has no key frame yet", "add one first");
    if (!flight.frames_folder.empty()) LUCARNE_TRY(prepare_frames_folder(flight.frames_folder, false));
    if (!flight.video.empty()) LUCARNE_TRY(VideoWriter::check(flight.video, false));
    return {};
}

RenderState first_state(const RenderOrder& order) {
    if (const auto* still = std::get_if<StillOrder>(&order.what))
        return {true, 0, still->frames, still->file.string()};
    const auto& flight = std::get<FlightOrder>(order.what);
    const auto& file = flight.video.empty() ? flight.frames_folder : flight.video;
    return {true, 0, flight.path.keys.empty() ? 0 : flight.path.frames(), file.string()};
}

}  // namespace

/// Counts a finished frame. Returns an error if the work has been cancelled.
Result<void> RenderWorker::State::frame_done() {
    {
        const std::lock_guard lock(mutex);
        ++shown.done;
    }
    changed();
    return stop ? failed(shown.file, kCancelled) : Result<void>();
}

Result<std::string> RenderWorker::State::still(Pipeline& pipeline, const RenderOrder& order,
                                               const StillOrder& what) {
    FrameRequest request;
    request.camera = what.camera;
    request.size = order.size;
    request.wait = true;
    request.accumulate = what.frames > 1;
    request.transparent = what.finish.transparent;
    for (uint32_t frame = 0; frame < what.frames; ++frame) {
        LUCARNE_TRY(pipeline.render(request));
        LUCARNE_TRY(frame_done());
    }
    LUCARNE_TRY(io::write_png(what.file, finished_picture(pipeline, what.camera, what.finish), false));
    return fmt::format("saved {} ({}x{})", what.file.string(), order.size.width, order.size.height);
}

Result<std::string> RenderWorker::State::flight(Pipeline& pipeline, const RenderOrder& order,
                                                const FlightOrder& what) {
    std::unique_ptr<VideoWriter> video;
    if (!what.video.empty()) {
        LUCARNE_ASSIGN(video,
                       VideoWriter::start(what.video, order.size, what.path.frames_per_second, false, stop));
    }
    FlightOptions how;
    how.size = order.size;
    if (!what.frames_folder.empty()) how.frames_folder = what.frames_folder;
    how.take_frame = [&](const io::Image8& picture, size_t) -> Result<void> {
        if (video) LUCARNE_TRY(video->add(picture));
        return frame_done();
    };
    LUCARNE_ASSIGN(const Flight flown, fly(pipeline, what.path, how));
    if (video) LUCARNE_TRY(video->finish());
    return fmt::format("saved {}: {} frames", shown.file, what.path.frames());
}

Result<std::string> RenderWorker::State::draw(const RenderOrder& order, const WorkerDevice& device) {
    LUCARNE_ASSIGN(const auto gl, device.make());
    LUCARNE_ASSIGN(const auto pipeline, Pipeline::open(*gl, order.source, order.caps));
    LUCARNE_TRY(pipeline->set_method(order.method));
    LUCARNE_TRY(pipeline->set_scene(order.scene));
    if (const auto* what = std::get_if<StillOrder>(&order.what)) return still(*pipeline, order, *what);
    return flight(*pipeline, order, std::get<FlightOrder>(order.what));
}

Result<std::string> RenderWorker::State::render(const RenderOrder& order, const WorkerDevice& device) {
    LUCARNE_TRY(check(order));
    auto drawn = guarded(shown.file, [&] { return draw(order, device); });
    device.release();
    return drawn;
}

void RenderWorker::State::finish(Result<std::string> done) {
    {
        const std::lock_guard lock(mutex);
        shown.running = false;
        outcome = std::move(done);
    }
    changed();
}

RenderWorker::RenderWorker(std::function<void()> changed) : state_(std::make_unique<State>()) {
    state_->changed = std::move(changed);
}

RenderWorker::~RenderWorker() {
    cancel();
}

bool RenderWorker::start(RenderOrder order, WorkerDevice device) {
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->shown.running) return false;
        state_->shown = first_state(order);
        state_->outcome.reset();
    }
    state_->stop = false;
    state_->jobs.push(
        "rendering",
        [state = state_.get(), order = std::move(order), device = std::move(device)] {
            return state->render(order, device);
        },
        [state = state_.get()](Result<std::string> done) { state->finish(std::move(done)); });
    return true;
}

void RenderWorker::cancel() {
    state_->stop = true;
}

RenderState RenderWorker::state() const {
    const std::lock_guard lock(state_->mutex);
    return state_->shown;
}

std::optional<Result<std::string>> RenderWorker::take_outcome() {
    const std::lock_guard lock(state_->mutex);
    return std::exchange(state_->outcome, std::nullopt);
}

}  // namespace lucarne::viewer
