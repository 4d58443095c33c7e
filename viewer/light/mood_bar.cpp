// The moods as buttons over the picture, where a newcomer finds them.
#include <cfloat>
#include <cmath>
#include <cstdio>

#include <imgui.h>

#include "gi/registry.h"
#include "viewer/light/day.h"
#include "viewer/light/lighting.h"
#include "viewer/light/preparing.h"
#include "viewer/opening/moods.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

float width_of(std::span<const MoodInfo> all) {
    const ImGuiStyle& style = ImGui::GetStyle();
    float width = 2 * style.WindowPadding.x - style.ItemSpacing.x;
    for (const MoodInfo& info : all)
        width += ImGui::CalcTextSize(info.label.data()).x + 2 * style.FramePadding.x + style.ItemSpacing.x;
    return width;
}

/// Lets the user choose the hour of the day. Until then the sun stands where it shows the scan best.
void draw_hour(const Lighting& model) {
    const gi::SceneLight* sun = first_sun(model.view.scene);
    if (!sun) return;
    gi::SunMoment moment = *moment_of_sun(model.view.scene);
    gi::LocalTime time = gi::local_time(moment.time);
    float hours = static_cast<float>(time.seconds) / 3600;
    char clock[32] = "time of day";
    if (sun->sun)
        std::snprintf(clock, sizeof clock, "%02d:%02d", time.seconds / 3600, time.seconds / 60 % 60);
    if (ImGui::Button(model.lights.plays_day ? "Stop" : "Play")) play_day(model);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("the day as a film, from dawn to dusk: an hour takes two seconds");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    const bool changed = ImGui::SliderFloat("##hour", &hours, 0, 23.99f, clock, ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive())
        ImGui::SetTooltip(
            "the sun of %04d-%02d-%02d at %.2f N, %.2f E; place and date are in the section Light", time.year,
            time.month, time.day, moment.latitude, moment.longitude);
    if (!changed) return;
    time.seconds = static_cast<int>(std::lround(hours * 60)) * 60;
    moment.time = gi::moment_of(time, moment.time.ahead);
    set_daytime(model.view.scene, moment);
    model.view.scene_changed();
}

}  // namespace

void draw_mood_bar(const Lighting& model) {
    if (model.view.site.outline.empty()) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const auto left = static_cast<float>(model.view.side_bar.pixels(ImGui::GetFontSize(), size.x));
    const float width = width_of(moods()) + preparing_button_width(model);
    if (size.x - left < 1.2f * width) return;  // it would hide the picture; the menu has them as well
    ImGui::SetNextWindowPos(ImVec2((left + size.x - width) / 2, mood_bar_span().x));
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, FLT_MAX));
    ImGui::SetNextWindowBgAlpha(0.45f);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                                   ImGuiWindowFlags_NoMove;
    if (ImGui::Begin("##moods", nullptr, flags)) {
        const bool lit = !gi::engine_is(model.view.method.engine, &gi::EngineInfo::unlit);
        for (const MoodInfo& info : moods()) {
            if (info.mood != moods().front().mood) ImGui::SameLine();
            const bool chosen = model.lights.mood == info.mood && lit == (info.mood != Mood::scan_colours);
            if (chosen)
                ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
            if (ImGui::Button(info.label.data())) take_mood(model, info.mood);
            if (chosen) ImGui::PopStyleColor();
            if (ImGui::IsItemHovered())
                ImGui::SetTooltip("%s\nEngine: %s", info.help.data(),
                                  gi::label_of(engine_here(model.view, info.mood)).c_str());
        }
        draw_preparing_bar(model);
        if (lit && model.lights.mood == Mood::daylight) draw_hour(model);
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
