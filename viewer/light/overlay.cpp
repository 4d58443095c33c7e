// Draws lights' handles, a comparison's border and the progress of convergence over the picture.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <imgui.h>

#include "gi/registry.h"
#include "viewer/light/edits.h"
#include "viewer/light/handles.h"
#include "viewer/picking/pick.h"
#include "viewer/window/panels/on_screen.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

constexpr float kHandle = 7, kGrip = 6;  // radius, to be scaled()
constexpr ImU32 kOn = IM_COL32(255, 226, 120, 255), kOff = IM_COL32(130, 130, 130, 255),
                kSelected = IM_COL32(255, 140, 40, 255), kRim = IM_COL32(20, 20, 20, 220),
                kBeam = IM_COL32(255, 226, 120, 130), kPaper = IM_COL32(10, 10, 10, 150);

LightSphere sky_of(const ViewModel& model) {
    return {model.rig.pivot(), model.scene_size / 5};
}

void drag(ViewModel& model, const LightHandle& handle) {
    gi::SceneLight& light = model.scene.lights[handle.light];
    const LightSphere sky = sky_of(model);
    const CameraRig::Ray ray = cursor_ray(model.rig);
    auto to = dragged_place(light, handle.part, sky, ray.from, ray.along, model.rig.forward());
    const ImGuiIO& io = ImGui::GetIO();
    // A dragged target moves to the surface under the cursor.
    if (handle.part == LightHandle::Part::target)
        if (const auto point =
                model.picture->pick({io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y}))
            to = point;
    if (to && move_light(light, handle.part, *to, sky)) model.scene_changed();
}

/// Draws one handle. Returns whether the mouse is on it.
bool draw_handle(const ViewModel& model, const LightHandle& handle, const ImVec2& at) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const gi::SceneLight& light = model.scene.lights[handle.light];
    const ImU32 colour = handle.light == model.light ? kSelected : light.on ? kOn : kOff;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const float x = at.x - mouse.x, y = at.y - mouse.y;
    const bool hovered =
        !ImGui::GetIO().WantCaptureMouse && x * x + y * y < 4 * scaled(kHandle) * scaled(kHandle);
    const float radius = scaled(hovered ? kHandle + 2 : kHandle);
    if (handle.part == LightHandle::Part::target) {
        list.AddCircle(at, radius - scaled(1), kRim, 0, scaled(4));
        list.AddCircle(at, radius - scaled(1), colour, 0, scaled(2));
    } else {
        list.AddCircleFilled(at, radius + scaled(1.5f), kRim);
        list.AddCircleFilled(at, radius, colour);
    }
    if (handle.part == LightHandle::Part::sky)  // rays
        for (int i = 0; i < 8; ++i) {
            const float angle = static_cast<float>(i) * std::numbers::pi_v<float> / 4, c = std::cos(angle),
                        s = std::sin(angle);
            const float from = radius + scaled(3), to = radius + scaled(7);
            list.AddLine({at.x + c * from, at.y + s * from}, {at.x + c * to, at.y + s * to}, colour,
                         scaled(2));
        }
    if ((hovered || handle.light == model.light) && handle.part != LightHandle::Part::target)
        list.AddText({at.x + radius + scaled(6), at.y - ImGui::GetFontSize() / 2}, colour,
                     light.name.c_str());
    return hovered;
}

void draw_beam(const ViewModel& model, const gi::SceneLight& light) {
    const LightSphere sky = sky_of(model);
    const bool sun = light.kind == gi::LightKind::directional;
    const auto from =
        on_screen(*model.picture, sun ? handle_place(light, LightHandle::Part::sky, sky) : light.position);
    const auto to = on_screen(*model.picture, sun ? sky.centre : light.target);
    if (from && to && light.kind != gi::LightKind::point)
        ImGui::GetBackgroundDrawList()->AddLine(*from, *to, kBeam, scaled(1.5f));
}

bool take_border(ViewModel& model) {
    LightTools& tools = model.light_tools;
    auto& comparison = model.scene.comparison;
    if (!comparison || comparison->show != gi::Comparison::Show::split) return tools.holds_border = false;
    const ImGuiIO& io = ImGui::GetIO();
    const float x = static_cast<float>(comparison->border) * io.DisplaySize.x;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const bool hovered = !io.WantCaptureMouse && std::abs(io.MousePos.x - x) < scaled(kGrip);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) tools.holds_border = false;
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) tools.holds_border = true;
    list.AddLine({x, 0}, {x, io.DisplaySize.y}, hovered || tools.holds_border ? kSelected : IM_COL32_WHITE,
                 scaled(2));
    const float font = ImGui::GetFontSize(), y = io.DisplaySize.y - 3.5f * font;
    const std::string left = model.engine, right = comparison->engine;
    const ImVec2 size = ImGui::CalcTextSize(left.c_str());
    const float right_width = ImGui::CalcTextSize(right.c_str()).x;
    const float gap = scaled(8), edge = scaled(14), above = scaled(3);
    list.AddRectFilled({x - size.x - edge, y - above}, {x + right_width + edge, y + size.y + above}, kPaper,
                       scaled(4));
    list.AddText({x - size.x - gap, y}, IM_COL32_WHITE, left.c_str());
    list.AddText({x + gap, y}, IM_COL32_WHITE, right.c_str());
    list.AddLine({x, y - above}, {x, y + size.y + above}, IM_COL32_WHITE, scaled(2));
    if (hovered || tools.holds_border) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (!tools.holds_border) return false;
    const double border = std::clamp(static_cast<double>(io.MousePos.x / io.DisplaySize.x), 0.0, 1.0);
    if (border != comparison->border) {
        comparison->border = border;
        model.shown_changed();
    }
    return true;
}

}  // namespace

bool take_light_handles(ViewModel& model) {
    if (!model.picture) return false;
    LightTools& tools = model.light_tools;
    if (take_border(model)) return true;
    if (!tools.show_handles || !model.side_bar().shown ||
        gi::engine_is(model.engine, &gi::EngineInfo::unlit)) {
        tools.held.reset();
        return false;
    }
    const auto handles = light_handles(model.scene.lights);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) tools.held.reset();
    if (tools.held && std::find(handles.begin(), handles.end(), *tools.held) == handles.end())
        tools.held.reset();
    if (const gi::SceneLight* light = model.selected_light()) draw_beam(model, *light);
    std::optional<LightHandle> under;
    for (const LightHandle& handle : handles) {
        // Show the target of the selected light only, so that pictures with many lights stay clear.
        if (handle.part == LightHandle::Part::target && handle.light != model.light) continue;
        const auto at = on_screen(*model.picture,
                                  handle_place(model.scene.lights[handle.light], handle.part, sky_of(model)));
        if (at && draw_handle(model, handle, *at)) under = handle;
    }
    if (under && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        remember_lights(model);
        tools.held = under;
        model.light = under->light;
        return true;
    }
    if (tools.held && (ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0))
        drag(model, *tools.held);
    return tools.held.has_value();
}

void draw_convergence(const ViewModel& model) {
    if (!model.picture || model.picture->stats.accumulated >= kMostAccumulated) return;
    const float share =
        model.picture->moving ? 0 : static_cast<float>(model.picture->stats.accumulated) / kMostAccumulated;
    const float font = ImGui::GetFontSize(), radius = 0.7f * font;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const ImVec2 centre(size.x - 7 * font, size.y - 1.2f * font);  // the line of messages is in the middle
    constexpr float kTop = -std::numbers::pi_v<float> / 2;
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddCircleFilled(centre, radius + scaled(4), kPaper);
    list.AddCircle(centre, radius, kOff, 32, scaled(3));
    list.PathArcTo(centre, radius, kTop, kTop + share * 2 * std::numbers::pi_v<float>, 32);
    list.PathStroke(kOn, 0, scaled(3));
    if (!model.picture->moving)
        list.AddText({centre.x + radius + scaled(7), centre.y - font / 2}, IM_COL32_WHITE,
                     fmt::format("{} of {}", model.picture->stats.accumulated, kMostAccumulated).c_str());
}

}  // namespace lucarne::viewer
