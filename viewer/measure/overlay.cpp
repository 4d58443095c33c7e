// Draws measurements over the picture.
#include <algorithm>

#include <imgui.h>

#include "viewer/measure/marks.h"
#include "viewer/measure/measuring.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr ImU32 kColor = IM_COL32(255, 220, 60, 255), kSelected = IM_COL32(90, 230, 255, 255),
                kPending = IM_COL32(255, 120, 90, 255), kPaper = IM_COL32(0, 0, 0, 170);
constexpr float kDimmed = 0.35f;       ///< opacity of what a surface hides
constexpr float kPadX = 5, kPadY = 3;  ///< padding around a label's text, before scaled()

ImVec2 at(const glm::dvec2& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y)};
}

ImU32 dimmed(ImU32 color, bool hidden) {
    const auto alpha =
        static_cast<ImU32>(static_cast<float>(color >> IM_COL32_A_SHIFT) * (hidden ? kDimmed : 1));
    return (color & ~IM_COL32_A_MASK) | alpha << IM_COL32_A_SHIFT;
}

struct Box {
    ImVec2 min, max;
};
Box box_of(const OverlayLabel& label) {
    const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
    const ImVec2 middle = at(label.at), pad(scaled(kPadX), scaled(kPadY));
    const float above = size.y;  // labels stand above the point or line, so as not to cover it
    return {{middle.x - size.x / 2 - pad.x, middle.y - above - size.y / 2 - pad.y},
            {middle.x + size.x / 2 + pad.x, middle.y - above + size.y / 2 + pad.y}};
}

template <class ColorOf>
void draw(const Overlay& overlay, bool labels, const ColorOf& color_of) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const OverlayLine& line : overlay.lines)
        list.AddLine(at(line.from), at(line.to), dimmed(color_of(line.measurement), line.hidden), scaled(2));
    for (const OverlayMark& mark : overlay.marks) {
        list.AddCircleFilled(at(mark.at), scaled(4), dimmed(color_of(mark.measurement), mark.hidden));
        list.AddCircle(at(mark.at), scaled(4.5f), dimmed(IM_COL32_BLACK, mark.hidden));
    }
    for (const OverlayLabel& label : overlay.labels) {
        if (!labels) continue;
        const Box box = box_of(label);
        list.AddRectFilled(box.min, box.max, dimmed(kPaper, label.hidden), scaled(4));
        list.AddText({box.min.x + scaled(kPadX), box.min.y + scaled(kPadY)},
                     dimmed(color_of(label.measurement), label.hidden), label.text.c_str());
    }
}

/// Returns the measurement whose label is under the cursor.
std::optional<size_t> label_under_cursor(const Overlay& overlay) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    for (auto label = overlay.labels.rbegin(); label != overlay.labels.rend(); ++label) {
        const Box box = box_of(*label);
        if (mouse.x >= box.min.x && mouse.x < box.max.x && mouse.y >= box.min.y && mouse.y < box.max.y)
            return label->measurement;
    }
    return std::nullopt;
}

void draw_pending(const Measuring& model, const glm::dvec2& window, const UnitChoice& units) {
    const MeasureModel& measure = model.measure;
    if (!measure.tool) return;
    const Measurement unfinished{*measure.tool, "", measure.pending, measure.thickness};
    const Overlay overlay = overlay_of({&unfinished, 1}, *model.view.picture, window, units);
    draw(overlay, true, [](size_t) { return kPending; });
    if (ImGui::GetIO().WantCaptureMouse) return;
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (!overlay.marks.empty() && measure.tool != MeasureKind::point)
        ImGui::GetBackgroundDrawList()->AddLine(at(overlay.marks.back().at), ImGui::GetIO().MousePos,
                                                dimmed(kPending, true), scaled(1));
}

}  // namespace

void draw_measurements(const Measuring& model) {
    MeasureModel& measure = model.measure;
    if (!model.view.picture) return;
    const ImGuiIO& io = ImGui::GetIO();
    const glm::dvec2 window(io.DisplaySize.x, io.DisplaySize.y);
    const UnitChoice units = measure.units();
    const Overlay overlay = overlay_of(measure.list.all(), *model.view.picture, window, units);
    draw(overlay, measure.labels, [&](size_t i) { return measure.selected == i ? kSelected : kColor; });
    if (!measure.tool && measure.labels && !io.WantCaptureMouse &&
        ImGui::IsMouseClicked(ImGuiMouseButton_Left))
        if (const auto under = label_under_cursor(overlay)) {
            measure.selected = under;
            model.view.side_bar.unfold(BarSection::measure);
        }
    draw_pending(model, window, units);
}

}  // namespace lucarne::viewer
