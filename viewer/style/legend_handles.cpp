#include "viewer/style/legend_handles.h"

#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "viewer/style/overlay_view.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr float kReach = 7,
                kThick = 3;  ///< half sizes that the mouse grabs, and that are drawn, before scaled()
constexpr ImU32 kInk = IM_COL32(255, 240, 200, 255), kLit = IM_COL32(255, 140, 40, 255),
                kRim = IM_COL32(20, 20, 20, 230);

/// Draws the handle of a bar's end at height `y`, and its value beside it.
void draw_handle(const LegendBar& bar, float y, double value, bool lit) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const float over = scaled(4), rim = scaled(1), half = scaled(kThick), round = scaled(2);
    const auto left = static_cast<float>(bar.from.x) - over, right = static_cast<float>(bar.to.x) + over;
    list.AddRectFilled({left - rim, y - half - rim}, {right + rim, y + half + rim}, kRim, round);
    list.AddRectFilled({left, y - half}, {right, y + half}, lit ? kLit : kInk, round);
    if (!lit) return;
    const std::string text = fmt::format("{:.6g}", value);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const ImVec2 at(left - size.x - scaled(12), y - size.y / 2), pad(scaled(4), scaled(3));
    list.AddRectFilled({at.x - pad.x, at.y - pad.y}, {at.x + size.x + pad.x, at.y + size.y + pad.y}, kRim,
                       scaled(3));
    list.AddText(at, kInk, text.c_str());
}

}  // namespace

bool LegendHandles::take(const Styling& model) {
    const auto bar = model.view.picture
                         ? legend_bar(model.view.scene.look, model.view.picture->values, overlay_view(model))
                         : std::nullopt;
    if (!bar || !ImGui::IsMouseDown(ImGuiMouseButton_Left)) held_.reset();
    if (!bar) return false;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const auto over = [&](const glm::dvec2& from, const glm::dvec2& to) {
        return mouse.x >= from.x && mouse.x < to.x && mouse.y >= from.y && mouse.y < to.y;
    };
    if (!held_ && (ImGui::GetIO().WantCaptureMouse || !over(bar->paper_from, bar->paper_to))) return false;
    gi::Look& look = model.view.scene.look;
    const gi::ValueRange range = look.range.value_or(*model.view.picture->values.range);
    const double reach = scaled(kReach);
    for (const RangeEnd end : {RangeEnd::low, RangeEnd::high}) {
        const double y = end == RangeEnd::high ? bar->from.y : bar->to.y;
        const bool hovered = !held_ && over({bar->from.x - reach, y - reach}, {bar->to.x + reach, y + reach});
        if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
            look.range.reset();
            model.view.scene_changed();
            return true;
        }
        if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
            held_ = Held{end, range, mouse.y};
        }
        const bool lit = held_ ? held_->end == end : hovered;
        const float moved = held_ && lit ? mouse.y - held_->y : 0;  // the handle follows the mouse
        draw_handle(*bar, static_cast<float>(y) + moved, end == RangeEnd::high ? range.high : range.low, lit);
        if (lit) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
    }
    if (!held_) return false;
    const double up = static_cast<double>(held_->y - mouse.y) / (bar->to.y - bar->from.y);
    const gi::ValueRange dragged = dragged_range(held_->range, held_->end, up);
    if (up != 0 && dragged != range) {
        look.range = dragged;
        model.view.scene_changed();
    }
    return true;
}

}  // namespace lucarne::viewer
