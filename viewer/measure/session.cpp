#include "viewer/measure/session.h"

#include <fmt/format.h>
#include <imgui.h>

#include "io/files/free_name.h"
#include "viewer/overlay/axis_marks.h"
#include "viewer/window/panels/on_screen.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

constexpr float kClickReach = 4;  ///< before scaled(): a longer move between press and release is a drag
}  // namespace

void MeasureSession::take_results(ViewModel& model) {
    MeasureModel& measure = model.measure;
    for (MeasureWorker::Pick& pick : worker_.take_picks()) {
        if (!pick)
            measure.message = pick.error().line();
        else if (!*pick)
            measure.message = "no point is seen there";
        else
            measure.take(std::move((*pick)->point));
    }
    if (auto message = worker_.take_message()) measure.message = std::move(*message);
}

void MeasureSession::follow_section(ViewModel& model) {
    MeasureModel& measure = model.measure;
    const Measurement* one = measure.selected_one();
    const bool shown = one && one->kind == MeasureKind::section && model.picture;
    if (shown) worker_.read(model.picture->source, Slice::of(*one));
    measure.section = shown ? worker_.section() : nullptr;
    if (!measure.save_section) return;
    measure.save_section = false;
    if (shown)
        worker_.save_section(free_name(model.pictures, "section", {".csv", ".svg"}), one->name,
                             measure.units());
}

void MeasureSession::files(ViewModel& model) {
    MeasureModel& measure = model.measure;
    if (measure.wish == MeasureModel::FileWish::none) return;
    if (measure.wish == MeasureModel::FileWish::load && !model.picture)
        return;  // the first scan determines the unit
    const auto wish = std::exchange(measure.wish, MeasureModel::FileWish::none);
    const auto path = model.pictures / measure.file;
    const bool save = wish == MeasureModel::FileWish::save;
    const auto done = save ? measure.save(path) : measure.load(path);
    if (!done)
        measure.message = done.error().line();
    else
        measure.message = save ? "saved " + path.string()
                               : fmt::format("{} measurements loaded", measure.list.all().size());
    if (done && !save) model.side_bar().unfold(BarSection::measure);
}

void MeasureSession::take_input(ViewModel& model) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool click =
        ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !io.WantCaptureMouse && !io.KeyShift &&
        io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < scaled(kClickReach) * scaled(kClickReach);
    if (click && model.measure.tool && model.picture) {
        const ImVec2 at = io.MouseClickedPos[ImGuiMouseButton_Left];
        worker_.pick(model.picture, {at.x / io.DisplaySize.x, at.y / io.DisplaySize.y});
    }
    if (model.picture) model.measure.set_unit(model.picture->metres_per_unit);
    if (model.picture && !(model.measure.thickness > 0))
        model.measure.thickness = axis_step(model.scene_size, 100);
    take_results(model);
    follow_section(model);
    files(model);
    if (!model.measure.message.empty()) model.message = std::exchange(model.measure.message, {});
}

void MeasureSession::draw(ViewModel& model) {
    draw_measurements(model);
    section_panel_.draw(model);
}

}  // namespace lucarne::viewer
