// Draws the selected section: along the line to the right, height upward, both with the same scale.
#include "viewer/measure/section_panel.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "viewer/overlay/axis_marks.h"

namespace lucarne::viewer {
namespace {

constexpr float kDot = 2;                           ///< side of a cell, pixels
constexpr float kColumnApart = 90, kRowApart = 36;  ///< approximate distance between axis marks, pixels
constexpr ImU32 kGrid = IM_COL32(90, 90, 90, 255), kText = IM_COL32(200, 200, 200, 255);

void axes(ImDrawList& list, const ProfileRaster& raster, const ImVec2& corner, const ImVec2& size,
          const UnitChoice& units) {
    const double unit = units.convert(1, Dimension::length),
                 pixels = raster.scale * kDot / unit;  // pixels per displayed unit
    const double left = raster.left * unit, bottom = raster.bottom * unit;
    const auto marks = [&](float length, float apart) {
        return axis_step(length / pixels, std::max(static_cast<int>(length / apart), 1));
    };
    const double step = marks(size.x, kColumnApart), row = marks(size.y, kRowApart);
    for (const double x : axis_marks(left, left + size.x / pixels, step)) {
        const float at = corner.x + static_cast<float>((x - left) * pixels);
        list.AddLine({at, corner.y}, {at, corner.y + size.y}, kGrid);
        list.AddText({at + 3, corner.y + size.y - ImGui::GetTextLineHeight()}, kText,
                     axis_text(x, step).c_str());
    }
    for (const double y : axis_marks(bottom, bottom + size.y / pixels, row)) {
        const float at = corner.y + size.y - static_cast<float>((y - bottom) * pixels);
        list.AddLine({corner.x, at}, {corner.x + size.x, at}, kGrid);
        if (at - corner.y > ImGui::GetTextLineHeight())
            list.AddText({corner.x + 3, at - ImGui::GetTextLineHeight()}, kText,
                         (axis_text(y, row) + " " + units.name(Dimension::length)).c_str());
    }
}

}  // namespace

void SectionPanel::draw(const Measuring& model) {
    MeasureModel& measure = model.measure;
    const Measurement* one = measure.selected_one();
    if (!one || one->kind != MeasureKind::section || !model.view.side_bar.is_open(BarSection::measure))
        return;
    const UnitChoice units = measure.units();
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize();
    const float left = static_cast<float>(model.view.side_bar.pixels(font, display.x)) + font;
    ImGui::SetNextWindowPos(ImVec2(left, display.y - font * 19), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(display.x - left - font, font * 17), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowBgAlpha(1);
    bool open = true;
    if (ImGui::Begin("Section", &open)) {
        const Section* section = measure.section.get();
        const bool whole = section && (section->complete || section->nodes_read == section->nodes);
        if (section)
            ImGui::Text(
                "%s: %zu points%s", one->name.c_str(), section->points.size(),
                whole ? ""
                      : fmt::format(", {} of {} nodes read", section->nodes_read, section->nodes).c_str());
        else
            ImGui::TextUnformatted("Reading the points.");
        ImGui::SameLine();
        ImGui::BeginDisabled(!section);
        if (ImGui::SmallButton("Save as CSV and SVG")) measure.commands.push(SaveSection{});
        ImGui::EndDisabled();
        const ImVec2 corner = ImGui::GetCursorScreenPos(), size = ImGui::GetContentRegionAvail();
        if (section && size.x > 20 && size.y > 20) plot(measure.section, corner, size, units);
    }
    ImGui::End();
    if (!open) measure.selected.reset();
}

void SectionPanel::plot(const std::shared_ptr<const Section>& section, const ImVec2& corner,
                        const ImVec2& size, const UnitChoice& units) {
    const auto columns = static_cast<uint32_t>(size.x / kDot), rows = static_cast<uint32_t>(size.y / kDot);
    if (section != drawn_ || columns != columns_ || rows != rows_) {
        raster_ = rasterize(*section, columns, rows);
        drawn_ = section;
        columns_ = columns;
        rows_ = rows;
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    axes(list, raster_, corner, size, units);
    for (const ProfileRaster::Dot& dot : raster_.dots) {
        const ImVec2 at(corner.x + kDot * dot.x, corner.y + kDot * dot.y);
        list.AddRectFilled(at, {at.x + kDot, at.y + kDot},
                           IM_COL32(dot.color[0], dot.color[1], dot.color[2], 255));
    }
}

}  // namespace lucarne::viewer
