#include "viewer/publish/session.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "io/core/counted.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {
namespace {

ImageSize size_of(int width, int height) {
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

RenderOrder order_of(const View& view, std::shared_ptr<const octree::NodeSource> source) {
    return {std::move(source), view.scene, view.method, view.caps, {}, view.site, {}};
}

RenderOrder picture_order(const Publishing& model, std::shared_ptr<const octree::NodeSource> source) {
    const PublishModel& publish = model.publish;
    RenderOrder order = order_of(model.view, std::move(source));
    order.size = size_of(publish.width, publish.height);
    order.what = StillOrder{model.view.rig.camera(), static_cast<uint32_t>(publish.frames), publish.finish,
                            model.view.pictures / publish.picture_file};
    return order;
}

/// `frames_folder` or `video` is empty.
RenderOrder flight_order(const Publishing& model, std::shared_ptr<const octree::NodeSource> source,
                         std::filesystem::path frames_folder, std::filesystem::path video) {
    const PublishModel& publish = model.publish;
    RenderOrder order = order_of(model.view, std::move(source));
    order.size = size_of(publish.flight_width, publish.flight_height);
    order.what = FlightOrder{publish.editor.path(), std::move(frames_folder), std::move(video)};
    return order;
}

}  // namespace

void PublishSession::path_files(const Publishing& model, bool save) {
    PublishModel& publish = model.publish;
    const auto file = model.view.pictures / publish.path_file;
    const auto done = save ? publish.save_path(file) : publish.load_path(file);
    const size_t keys = publish.editor.path().keys.size();
    publish.message = !done  ? done.error().line()
                      : save ? "saved " + whole_path(file)
                             : counted(keys, "key frames") + " loaded";
}

void PublishSession::carry_out(const Publishing& model,
                               const std::shared_ptr<const octree::NodeSource>& source) {
    PublishModel& publish = model.publish;
    const auto& folder = model.view.pictures;
    const auto start = [&](const auto& order) {
        if (!source)
            publish.message = "there is nothing to render";
        else
            publish.take(render(order()));
    };
    const Overloaded run{
        [&](SavePath) { path_files(model, true); },
        [&](LoadPath) { path_files(model, false); },
        [&](RenderPicture) { start([&] { return picture_order(model, source); }); },
        [&](RenderFrames) {
            start([&] { return flight_order(model, source, folder / publish.frames_folder, {}); });
        },
        [&](RenderVideo) {
            start([&] { return flight_order(model, source, {}, folder / publish.video_file); });
        },
        [&](CancelRendering) { worker_.cancel(); },
    };
    for (const auto& command : publish.commands.take()) std::visit(run, command);
}

/// Renders with a new context each time, so that a failure of the last context has no effect.
Result<void> PublishSession::render(RenderOrder order) {
    if (worker_.state().running)
        return failed(worker_.state().file, "is still being rendered", "wait, or cancel it");
    LUCARNE_ASSIGN(WorkerDevice device, device_());
    worker_.start(std::move(order), std::move(device));
    return {};
}

bool PublishSession::follow(const Publishing& model,
                            const std::shared_ptr<const octree::NodeSource>& source) {
    PublishModel& publish = model.publish;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    publish.set_sizes(static_cast<int>(window.x), static_cast<int>(window.y));
    if (auto outcome = worker_.take_outcome())  // before the next order discards it
        publish.message = *outcome ? std::move(**outcome) : outcome->error().line();
    carry_out(model, source);
    publish.rendering = worker_.state();
    if (!publish.message.empty()) model.view.message = std::exchange(publish.message, {});
    publish.advance(ImGui::GetIO().DeltaTime);
    if (!std::exchange(publish.sought, false) || publish.editor.empty()) return false;
    model.view.go_to(publish.editor.path().at(publish.time));
    return true;
}

}  // namespace lucarne::viewer
