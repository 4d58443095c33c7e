#include "viewer/publish/render_worker.h"

#include <utility>

#include <fmt/format.h>

#include "io/files/file.h"
#include "viewer/flythrough/flight.h"
#include "viewer/flythrough/video.h"
#include "viewer/opening/first_view.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {

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
Result<void> RenderWorker::frame_done() {
    work_.update([](RenderState& shown) {
        ++shown.done;
        return true;
    });
    return work_.cancelled() ? failed(work_.shown().file, kCancelled) : Result<void>();
}

Result<std::string> RenderWorker::still(Pipeline& pipeline, const RenderOrder& order,
                                        const StillOrder& what) {
    FrameRequest request;
    request.camera = what.camera;
    request.size = order.size;
    request.wait = true;
    request.accumulate = what.frames > 1;
    request.transparent = what.finish.transparent;
    request.front_only = looks_in_from_outside(order.site, what.camera);
    for (uint32_t frame = 0; frame < what.frames; ++frame) {
        LUCARNE_TRY(pipeline.render(request));
        LUCARNE_TRY(frame_done());
    }
    LUCARNE_TRY(io::write_png(what.file, finished_picture(pipeline, what.camera, what.finish), false));
    return fmt::format("saved {} ({}x{})", whole_path(what.file), order.size.width, order.size.height);
}

Result<std::string> RenderWorker::flight(Pipeline& pipeline, const RenderOrder& order,
                                         const FlightOrder& what) {
    std::unique_ptr<VideoWriter> video;
    if (!what.video.empty()) {
        LUCARNE_ASSIGN(video, VideoWriter::start(what.video, order.size, what.path.frames_per_second, false,
                                                 work_.cancelled()));
    }
    FlightOptions how;
    how.size = order.size;
    how.site = order.site;
    how.scene = order.scene;
    if (!what.frames_folder.empty()) how.frames_folder = what.frames_folder;
    how.take_frame = [&](const io::Image8& picture, size_t) -> Result<void> {
        if (video) LUCARNE_TRY(video->add(picture));
        return frame_done();
    };
    LUCARNE_ASSIGN(const Flight flown, fly(pipeline, what.path, how));
    if (video) LUCARNE_TRY(video->finish());
    return fmt::format("saved {}: {} frames", whole_path(work_.shown().file), what.path.frames());
}

Result<std::string> RenderWorker::draw(const RenderOrder& order, const WorkerDevice& device) {
    LUCARNE_ASSIGN(const auto gl, device.make());
    LUCARNE_ASSIGN(const auto pipeline, Pipeline::open(*gl, order.source, order.caps));
    LUCARNE_TRY(pipeline->set_method(order.method));
    LUCARNE_TRY(pipeline->set_scene(order.scene));
    if (const auto* what = std::get_if<StillOrder>(&order.what)) return still(*pipeline, order, *what);
    return flight(*pipeline, order, std::get<FlightOrder>(order.what));
}

Result<std::string> RenderWorker::render(const RenderOrder& order, const WorkerDevice& device) {
    LUCARNE_TRY(check(order));
    auto drawn = guarded(work_.shown().file, [&] { return draw(order, device); });
    device.release();
    return drawn;
}

bool RenderWorker::start(RenderOrder order, WorkerDevice device) {
    RenderState first = first_state(order);
    return work_.start(
        "rendering", std::move(first),
        [this, order = std::move(order), device = std::move(device)] { return render(order, device); });
}

}  // namespace lucarne::viewer
