#include <cfloat>

#include <imgui.h>

#include "viewer/light/preparing.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

constexpr const char* kLabel = "Prepare";

/// Draws the button that starts it, greyed out with the reason where it cannot run.
void start_button(const Lighting& model) {
    const std::string why_not = why_not_prepared(model);
    if (!why_not.empty()) ImGui::BeginDisabled();
    if (ImGui::Button(kLabel)) prepare(model);
    if (!why_not.empty()) ImGui::EndDisabled();
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    const std::string text = preparing_gain() + "\n" + (why_not.empty() ? preparing_cost(model) : why_not);
    ImGui::SetTooltip("%s", text.c_str());
}

/// Draws how far it is, and a button that stops it.
void draw_progress(const Lighting& model) {
    const char* const stop = "Stop";
    const ImGuiStyle& style = ImGui::GetStyle();
    const float button = ImGui::CalcTextSize(stop).x + 2 * style.FramePadding.x;
    const std::string text = "Preparing light: " + preparing_progress(model);
    ImGui::ProgressBar(static_cast<float>(prepared_share(model.view)),
                       ImVec2(-button - style.ItemSpacing.x, 0), text.c_str());
    ImGui::SameLine();
    if (ImGui::Button(stop)) stop_preparing(model);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", what_stopping_keeps(model).c_str());
}

}  // namespace

void draw_preparing(const Lighting& model) {
    if (!fold("Light in advance")) return;
    if (is_preparing(model)) return draw_progress(model);
    const std::string state = prepared_state(model), why_not = why_not_prepared(model);
    const auto text = [](const std::string& of) { ImGui::TextWrapped("%s", of.c_str()); };
    if (!state.empty()) return text(state);
    start_button(model);
    text(why_not.empty() ? preparing_cost(model) : why_not);
    if (!model.lights.preparation.problem.empty()) text(model.lights.preparation.problem);
}

float preparing_button_width(const Lighting& model) {
    if (!shows_rooms(model.view) || model.view.is_prepared || is_preparing(model)) return 0;
    const ImGuiStyle& style = ImGui::GetStyle();
    return ImGui::CalcTextSize(kLabel).x + 2 * style.FramePadding.x + 3 * style.ItemSpacing.x;
}

void draw_preparing_bar(const Lighting& model) {
    if (is_preparing(model)) return draw_progress(model);
    if (preparing_button_width(model) == 0) return;
    ImGui::SameLine(0, 3 * ImGui::GetStyle().ItemSpacing.x);
    start_button(model);
}

}  // namespace lucarne::viewer
