#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "viewer/ui/on_screen.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {

void draw_status_line(const ViewModel& model) {
    const ImGuiIO& io = ImGui::GetIO();
    const auto& picture = model.view.picture;
    if (!picture || io.WantCaptureMouse || !ImGui::IsMousePosValid()) return;
    const auto point = picture->pick(cursor());
    if (!point) return;
    // Millimetres, whatever the unit.
    const int decimals = std::max(0L, std::lround(3 + std::log10(picture->metres_per_unit)));
    const std::string text =
        fmt::format("{:.{}f}  {:.{}f}  {:.{}f}", point->x, decimals, point->y, decimals, point->z, decimals);
    const ImVec2 padding = ImGui::GetStyle().WindowPadding, size = ImGui::CalcTextSize(text.c_str());
    ImGui::SetNextWindowPos(ImVec2(convergence_left() - scaled(8), io.DisplaySize.y - scaled(8)),
                            ImGuiCond_Always, ImVec2(1.0f, 1.0f));
    ImGui::SetNextWindowSize(ImVec2(size.x + 2 * padding.x, size.y + 2 * padding.y));
    ImGui::SetNextWindowBgAlpha(0.6f);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
    if (ImGui::Begin("##coordinates", nullptr, flags)) ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

}  // namespace lucarne::viewer
