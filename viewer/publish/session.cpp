#include "viewer/publish/session.h"

#include <utility>

#include <fmt/format.h>
#include <imgui.h>

namespace lucarne::viewer {
namespace {

using Wish = ShowModel::Wish;

ImageSize size_of(int width, int height) {
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

RenderOrder order_of(const ViewModel& model, std::shared_ptr<const octree::NodeSource> source, Wish wish) {
    const ShowModel& show = model.show;
    RenderOrder order{std::move(source), model.scene, model.engine, model.settings,
                      model.budgets,     model.caps,  {},           {}};
    if (wish == Wish::picture) {
        order.size = size_of(show.width, show.height);
        order.what = StillOrder{model.rig.camera(), static_cast<uint32_t>(show.frames), show.finish,
                                model.pictures / show.picture_file};
        return order;
    }
    order.size = size_of(show.flight_width, show.flight_height);
    FlightOrder flight{show.editor.path(), {}, {}};
    if (wish == Wish::frames) flight.frames_folder = model.pictures / show.frames_folder;
    if (wish == Wish::video) flight.video = model.pictures / show.video_file;
    order.what = std::move(flight);
    return order;
}

}  // namespace

void ShowSession::path_files(ViewModel& model, bool save) {
    ShowModel& show = model.show;
    const auto file = model.pictures / show.path_file;
    const auto done = save ? show.save_path(file) : show.load_path(file);
    show.message =
        done ? fmt::format("{} {}", save ? "saved" : "loaded", file.string()) : done.error().line();
}

void ShowSession::fulfil(ViewModel& model, const std::shared_ptr<const octree::NodeSource>& source) {
    ShowModel& show = model.show;
    const Wish wish = std::exchange(show.wish, Wish::none);
    if (wish == Wish::none) return;
    if (wish == Wish::cancel) return worker_.cancel();
    if (wish == Wish::save_path || wish == Wish::load_path) return path_files(model, wish == Wish::save_path);
    if (!source)
        show.message = "there is nothing to render";
    else
        show.take(render(order_of(model, source, wish)));
}

/// Renders with a new context each time, so that a failure of the last context has no effect.
Result<void> ShowSession::render(RenderOrder order) {
    if (worker_.state().running)
        return failed(worker_.state().file, "is still being rendered", "wait, or cancel it");
    LUCARNE_ASSIGN(WorkerDevice device, device_());
    worker_.start(std::move(order), std::move(device));
    return {};
}

bool ShowSession::follow(ViewModel& model, const std::shared_ptr<const octree::NodeSource>& source) {
    ShowModel& show = model.show;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    show.set_sizes(static_cast<int>(window.x), static_cast<int>(window.y));
    if (auto outcome = worker_.take_outcome())  // before the next order discards it
        show.message = *outcome ? std::move(**outcome) : outcome->error().line();
    fulfil(model, source);
    show.rendering = worker_.state();
    if (!show.message.empty()) model.message = std::exchange(show.message, {});
    show.advance(ImGui::GetIO().DeltaTime);
    if (!std::exchange(show.sought, false) || show.editor.empty()) return false;
    model.go_to(show.editor.path().at(show.time));
    return true;
}

}  // namespace lucarne::viewer
