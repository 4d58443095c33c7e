// Draws a comparison's border and the progress of convergence over the picture.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <imgui.h>

#include "gi/registry.h"
#include "viewer/rendering/rendering.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr float kGrip = 6;  // half the width that the mouse grabs, to be scaled()
constexpr ImU32 kShare = IM_COL32(255, 226, 120, 255), kRing = IM_COL32(130, 130, 130, 255),
                kGrasped = IM_COL32(255, 140, 40, 255);

/// Returns an engine's label at the border. Says so while that side still shows another engine's light.
std::string side_label(std::string_view wanted, std::string_view drawn) {
    return gi::label_of(wanted) + (wanted == drawn ? "" : " (rendering)");
}

/// Returns the width of the sign's text with the room around it, pixels.
float text_width(const std::string& text) {
    return ImGui::CalcTextSize(text.c_str()).x + scaled(9);
}

/// The sign of convergence in the window's lower right corner.
struct SignShape {
    ImVec2 centre;
    float radius, across;  ///< of the ring and of its plate, pixels
};
/// Leaves room for the longest text, so that the sign stays where it is.
SignShape sign_shape() {
    const float font = ImGui::GetFontSize(), radius = 0.7f * font, across = radius + scaled(4);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float longest = text_width(fmt::format("{0} of {0}", kMostAccumulated));
    return {{size.x - scaled(8) - longest - across, size.y - 1.2f * font}, radius, across};
}

}  // namespace

bool take_comparison_border(const Rendering& model) {
    if (!model.view.picture) return false;
    auto& comparison = model.view.scene.comparison;
    if (!comparison || comparison->show != gi::Comparison::Show::split) return model.holds_border = false;
    const ImGuiIO& io = ImGui::GetIO();
    const float x = static_cast<float>(comparison->border) * io.DisplaySize.x;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const bool hovered = !io.WantCaptureMouse && std::abs(io.MousePos.x - x) < scaled(kGrip);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) model.holds_border = false;
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) model.holds_border = true;
    list.AddLine({x, 0}, {x, io.DisplaySize.y}, hovered || model.holds_border ? kGrasped : IM_COL32_WHITE,
                 scaled(2));
    const float font = ImGui::GetFontSize(), y = io.DisplaySize.y - 3.5f * font;
    const FrameStats& shown = model.view.picture->stats;
    const std::string left = side_label(model.view.method.engine, shown.lit_by);
    const std::string right = side_label(comparison->engine, shown.compared_with);
    const ImVec2 size = ImGui::CalcTextSize(left.c_str());
    const float right_width = ImGui::CalcTextSize(right.c_str()).x;
    const float gap = scaled(8), edge = scaled(14), above = scaled(3);
    draw_plate(list, {x - size.x - edge, y - above}, {x + right_width + edge, y + size.y + above}, scaled(4));
    list.AddText({x - size.x - gap, y}, IM_COL32_WHITE, left.c_str());
    list.AddText({x + gap, y}, IM_COL32_WHITE, right.c_str());
    list.AddLine({x, y - above}, {x, y + size.y + above}, IM_COL32_WHITE, scaled(2));
    if (hovered || model.holds_border) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (!model.holds_border) return false;
    const double border = std::clamp(static_cast<double>(io.MousePos.x / io.DisplaySize.x), 0.0, 1.0);
    if (border != comparison->border) {
        comparison->border = border;
        model.view.shown_changed();
    }
    return true;
}

float convergence_left() {
    const SignShape sign = sign_shape();
    return sign.centre.x - sign.across;
}

void draw_convergence(const View& view) {
    if (!view.picture || view.picture->stats.accumulated >= kMostAccumulated) return;
    const float share =
        view.picture->moving ? 0 : static_cast<float>(view.picture->stats.accumulated) / kMostAccumulated;
    const auto [centre, radius, across] = sign_shape();
    const float font = ImGui::GetFontSize();
    constexpr float kTop = -std::numbers::pi_v<float> / 2;
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const std::string text = view.picture->moving
                                 ? ""
                                 : fmt::format("{} of {}", view.picture->stats.accumulated, kMostAccumulated);
    const float width = text.empty() ? 0 : text_width(text);
    draw_plate(list, {centre.x - across, centre.y - across}, {centre.x + across + width, centre.y + across},
               across);
    list.AddCircle(centre, radius, kRing, 32, scaled(3));
    list.PathArcTo(centre, radius, kTop, kTop + share * 2 * std::numbers::pi_v<float>, 32);
    list.PathStroke(kShare, 0, scaled(3));
    list.AddText({centre.x + radius + scaled(7), centre.y - font / 2}, IM_COL32_WHITE, text.c_str());
}

}  // namespace lucarne::viewer
