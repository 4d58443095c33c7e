// The panel of measuring tools, measurements, and all data of the selected measurement's points.
#include <algorithm>
#include <string>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/measure/measuring.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

void tool_buttons(MeasureModel& measure) {
    // Two columns of a button and its explanation, which fit into the narrowest bar.
    const ImGuiStyle& style = ImGui::GetStyle();
    const float mark = ImGui::CalcTextSize("?").x + style.ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - style.ItemSpacing.x) / 2 - mark;
    for (size_t i = 0; i < measure_kinds().size(); ++i) {
        const auto kind = static_cast<MeasureKind>(i);
        const bool active = measure.tool == kind;
        if (active) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        if (i % 2 != 0) ImGui::SameLine();
        if (ImGui::Button(measure_kinds()[i].title.data(), ImVec2(width, 0)))
            active ? measure.stop() : measure.start(kind);
        if (active) ImGui::PopStyleColor();
        help_mark(measure_kinds()[i].help);
    }
    if (!measure.tool) return;
    const MeasureKindInfo& info = info_of(*measure.tool);
    ImGui::TextWrapped("Click %s. %zu taken; Escape ends.", info.hint.data(), measure.pending.size());
    if (info.most > info.least) {
        ImGui::BeginDisabled(measure.pending.size() < info.least);
        if (ImGui::Button("Finish")) measure.finish();
        ImGui::EndDisabled();
    }
}

void thickness_field(MeasureModel& measure, const UnitChoice& units) {
    const Measurement* one = measure.selected_one();
    const bool of_selected = one && one->kind == MeasureKind::section;
    if (!of_selected && measure.tool != MeasureKind::section) return;
    const double unit = units.convert(1, Dimension::length);
    double shown = (of_selected ? one->thickness : measure.thickness) * unit;
    const std::string label = "thickness, " + units.name(Dimension::length);
    ImGui::InputDouble(LeftLabel(label), &shown, 0, 0, "%.4g");
    if (!ImGui::IsItemDeactivatedAfterEdit() || !(shown >= 0) || !(shown < 1e12)) return;
    measure.thickness = shown / unit;
    if (of_selected) measure.list.set_thickness(*measure.selected, measure.thickness);
}

void list_of(MeasureModel& measure, const UnitChoice& units) {
    if (!ImGui::BeginListBox("##all", ImVec2(-1, ImGui::GetTextLineHeightWithSpacing() * 6))) return;
    const auto& all = measure.list.all();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(all.size()));
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
            const auto i = static_cast<size_t>(row);
            const auto values = quantities(all[i]);
            const std::string text =
                all[i].name +
                (values.empty() ? "" : "   " + units.text(values[0].value, values[0].dimension));
            ImGui::PushID(row);
            if (ImGui::Selectable(text.c_str(), measure.selected == i))
                measure.selected = measure.selected == i ? std::nullopt : std::optional(i);
            ImGui::PopID();
        }
    ImGui::EndListBox();
}

void row(const char* name, const std::string& value) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(value.c_str());
}

void details(MeasureModel& measure, const UnitChoice& units) {
    const Measurement* one = measure.selected_one();
    if (!one) return;
    std::string name = one->name;
    if (ImGui::InputText(LeftLabel("Name"), &name, ImGuiInputTextFlags_EnterReturnsTrue) ||
        ImGui::IsItemDeactivatedAfterEdit())
        measure.list.rename(*measure.selected, name);
    one = measure.selected_one();
    if (!ImGui::BeginTable("details", 2, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) return;
    for (const Quantity& q : quantities(*one)) row(q.name.c_str(), units.text(q.value, q.dimension));
    constexpr size_t kMostShown = 20;
    for (size_t i = 0; i < std::min(one->points.size(), kMostShown); ++i) {
        const ExactPoint& point = one->points[i];
        static constexpr const char* kAxes[] = {"x", "y", "z"};
        row(("point " + std::to_string(i + 1)).c_str(), "in " + unit_name(units.metres_per_unit));
        for (size_t axis = 0; axis < 3; ++axis) row(kAxes[axis], point.coordinates[axis]);
        for (const PointField& field : point.fields) row(field.name.c_str(), field.value);
    }
    ImGui::EndTable();
}

void edit_buttons(MeasureModel& measure, const UnitChoice& units) {
    const auto button = [](const char* label, bool enabled) {
        ImGui::BeginDisabled(!enabled);
        const bool pressed = ImGui::Button(label);
        ImGui::EndDisabled();
        return pressed;
    };
    if (button("Delete", measure.selected_one())) measure.remove_selected();
    ImGui::SameLine();
    if (button("Copy", !measure.list.all().empty())) measure.copy_selected();
    ImGui::SameLine();
    ImGui::Checkbox("Labels", &measure.labels);
    if (ImGui::RadioButton("Metres", measure.metres)) measure.metres = true;
    ImGui::SameLine();
    if (ImGui::RadioButton(("file's unit: " + unit_name(units.metres_per_unit)).c_str(), !measure.metres))
        measure.metres = false;
    ImGui::InputText(LeftLabel("File"), &measure.file);
    if (button("Save", !measure.list.all().empty())) measure.commands.push(SaveMeasurements{});
    ImGui::SameLine();
    if (button("Load", true)) measure.commands.push(LoadMeasurements{});
    ImGui::SameLine();
    ImGui::TextDisabled(".csv or .json");
}

}  // namespace

void draw_measure_panel(const Measuring& model) {
    MeasureModel& measure = model.measure;
    const UnitChoice units = measure.units();
    tool_buttons(measure);
    thickness_field(measure, units);
    list_of(measure, units);
    edit_buttons(measure, units);
    details(measure, units);
}

}  // namespace lucarne::viewer
