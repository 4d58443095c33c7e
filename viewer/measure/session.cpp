#include "viewer/measure/session.h"

#include <fmt/format.h>
#include <imgui.h>

#include "io/files/free_name.h"
#include "viewer/measure/measuring.h"
#include "viewer/overlay/axis_marks.h"
#include "viewer/ui/on_screen.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {
namespace {

constexpr float kClickReach = 4;  ///< before scaled(): a longer move between press and release is a drag
}  // namespace

void MeasureSession::take_results(const Measuring& model) {
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

/// Reads the points of the selected section.
void MeasureSession::follow_section(const Measuring& model) {
    MeasureModel& measure = model.measure;
    const Measurement* one = measure.selected_one();
    const bool shown = one && one->kind == MeasureKind::section && model.view.picture;
    if (shown) worker_.read(model.view.picture->source, Slice::of(*one));
    measure.section = shown ? worker_.section() : nullptr;
}

void MeasureSession::save(const Measuring& model) {
    const auto path = model.view.pictures / model.measure.file;
    const auto done = model.measure.save(path);
    model.measure.message = done ? "saved " + whole_path(path) : done.error().line();
}

void MeasureSession::load(const Measuring& model) {
    const auto done = model.measure.load(model.view.pictures / model.measure.file);
    if (done) model.view.side_bar.unfold(BarSection::measure);
    model.measure.message =
        done ? fmt::format("{} measurements loaded", model.measure.list.all().size()) : done.error().line();
}

void MeasureSession::save_section(const Measuring& model) {
    const Measurement* one = model.measure.selected_one();
    if (one && one->kind == MeasureKind::section)
        worker_.save_section(free_name(model.view.pictures, "section", {".csv", ".svg"}), one->name,
                             model.measure.units());
}

void MeasureSession::carry_out(const Measuring& model) {
    if (!model.view.picture) return;
    const Overloaded run{
        [&](const SaveMeasurements&) { save(model); },
        [&](const LoadMeasurements&) { load(model); },
        [&](const SaveSection&) { save_section(model); },
        [&](const CopyText& copy) { ImGui::SetClipboardText(copy.text.c_str()); },
    };
    for (const auto& command : model.measure.commands.take()) std::visit(run, command);
}

void MeasureSession::take_input(const Measuring& model) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool click =
        ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !io.WantCaptureMouse && !io.KeyShift &&
        io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < scaled(kClickReach) * scaled(kClickReach);
    if (click && model.measure.tool && model.view.picture) {
        const ImVec2 at = io.MouseClickedPos[ImGuiMouseButton_Left];
        worker_.pick(model.view.picture, {at.x / io.DisplaySize.x, at.y / io.DisplaySize.y});
    }
    if (model.view.picture) model.measure.set_unit(model.view.picture->metres_per_unit);
    if (model.view.picture && !(model.measure.thickness > 0))
        model.measure.thickness = axis_step(model.view.scene_size, 100);
    take_results(model);
    follow_section(model);
    carry_out(model);
    if (!model.measure.tool && !model.measure.prompt.empty()) {
        if (model.view.message == model.measure.prompt) model.view.message.clear();
        model.measure.prompt.clear();
    }
    if (!model.measure.message.empty()) model.view.message = std::exchange(model.measure.message, {});
}

void MeasureSession::draw(const Measuring& model) {
    draw_measurements(model);
    section_panel_.draw(model);
}

}  // namespace lucarne::viewer
