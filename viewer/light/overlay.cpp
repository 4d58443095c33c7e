// Draws lights' handles over the picture.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <imgui.h>

#include "gi/registry.h"
#include "viewer/light/edits.h"
#include "viewer/light/handles.h"
#include "viewer/light/lighting.h"
#include "viewer/picking/pick.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr float kHandle = 7;  // radius, to be scaled()
constexpr ImU32 kOn = IM_COL32(255, 226, 120, 255), kOff = IM_COL32(130, 130, 130, 255),
                kSelected = IM_COL32(255, 140, 40, 255), kRim = IM_COL32(20, 20, 20, 220),
                kBeam = IM_COL32(255, 226, 120, 130);

LightSphere sky_of(const Lighting& model) {
    return {model.view.rig.pivot(), model.view.scene_size / 5};
}

void drag(const Lighting& model, const LightHandle& handle) {
    gi::SceneLight& light = model.view.scene.lights[handle.light];
    const LightSphere sky = sky_of(model);
    const CameraRig::Ray ray = cursor_ray(model.view.rig);
    auto to = dragged_place(light, handle.part, sky, ray.from, ray.along, model.view.rig.forward());
    const ImGuiIO& io = ImGui::GetIO();
    // A dragged target moves to the surface under the cursor.
    if (handle.part == LightHandle::Part::target)
        if (const auto point = model.view.picture->pick(
                {io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y}))
            to = point;
    if (!to || !move_light(light, handle.part, *to, sky)) return;
    model.lights.mood.reset();
    model.view.scene_changed();
}

/// Draws one handle. Returns whether the mouse is on it.
bool draw_handle(const Lighting& model, const LightHandle& handle, const ImVec2& at) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const gi::SceneLight& light = model.view.scene.lights[handle.light];
    const ImU32 colour = handle.light == model.lights.selected ? kSelected : light.on ? kOn : kOff;
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
    if ((hovered || handle.light == model.lights.selected) && handle.part != LightHandle::Part::target) {
        const ImVec2 size = ImGui::CalcTextSize(light.name.c_str());
        const ImVec2 from(at.x + radius + scaled(6), at.y - size.y / 2);
        draw_plate(list, {from.x - scaled(3), from.y - scaled(2)},
                   {from.x + size.x + scaled(3), from.y + size.y + scaled(2)}, scaled(3));
        list.AddText(from, colour, light.name.c_str());
    }
    return hovered;
}

void draw_beam(const Lighting& model, const gi::SceneLight& light) {
    const LightSphere sky = sky_of(model);
    const bool sun = light.kind == gi::LightKind::directional;
    const auto from = on_screen(*model.view.picture,
                                sun ? handle_place(light, LightHandle::Part::sky, sky) : light.position);
    const auto to = on_screen(*model.view.picture, sun ? sky.centre : light.target);
    if (from && to && light.kind != gi::LightKind::point)
        ImGui::GetBackgroundDrawList()->AddLine(*from, *to, kBeam, scaled(1.5f));
}

}  // namespace

bool take_light_handles(const Lighting& model) {
    if (!model.view.picture) return false;
    LightModel& tools = model.lights;
    if (!tools.show_handles || !model.view.side_bar.shows(BarSection::light) ||
        gi::engine_is(model.view.method.engine, &gi::EngineInfo::unlit)) {
        tools.held.reset();
        return false;
    }
    const auto handles = light_handles(model.view.scene.lights);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) tools.held.reset();
    if (tools.held && std::find(handles.begin(), handles.end(), *tools.held) == handles.end())
        tools.held.reset();
    if (const gi::SceneLight* light = model.selected_light()) draw_beam(model, *light);
    std::optional<LightHandle> under;
    for (const LightHandle& handle : handles) {
        // Show the target of the selected light only, so that pictures with many lights stay clear.
        if (handle.part == LightHandle::Part::target && handle.light != model.lights.selected) continue;
        const auto at = on_screen(*model.view.picture, handle_place(model.view.scene.lights[handle.light],
                                                                    handle.part, sky_of(model)));
        if (at && draw_handle(model, handle, *at)) under = handle;
    }
    if (under && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        tools.held = under;
        model.lights.selected = under->light;
        return true;
    }
    if (tools.held && (ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0))
        drag(model, *tools.held);
    return tools.held.has_value();
}

}  // namespace lucarne::viewer
