#include <algorithm>
#include <optional>

#include <imgui.h>

#include "viewer/picking/pick.h"
#include "viewer/style/styling.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

constexpr float kHandle = 7;  // radius, to be scaled()
constexpr ImU32 kEdge = IM_COL32(255, 210, 80, 200), kFace = IM_COL32(255, 240, 200, 255),
                kHeld = IM_COL32(255, 120, 40, 255);

void draw_edges(const Picture& picture, const gi::ClipBox& box) {
    const auto corners = box_corners(box);
    for (size_t i = 0; i < 8; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            if (i >> axis & 1) continue;
            const auto from = on_screen(picture, corners[i]),
                       to = on_screen(picture, corners[i | 1u << axis]);
            if (from && to) ImGui::GetBackgroundDrawList()->AddLine(*from, *to, kEdge, scaled(1.5f));
        }
}

void drag(const Styling& model, const ClipHandle& handle) {
    if (!handle.plane && handle.face == ClipHandle::kCorner) {
        gi::ClipBox& box = model.view.scene.look.clip.boxes[handle.index];
        const CameraRig::Ray ray = cursor_ray(model.view.rig);
        const auto turned = turned_to(box, ray.from, ray.along);
        if (!turned || *turned == box.rotation) return;
        box.rotation = *turned;
        return model.view.scene_changed();
    }
    const HandlePlace place = handle_place(model.view.scene.look.clip, handle);
    const CameraRig::Ray ray = cursor_ray(model.view.rig);
    const auto by = along_axis(place.position, place.axis, ray.from, ray.along);
    if (!by || *by == 0) return;
    move_handle(model.view.scene.look.clip, handle, *by);
    model.view.scene_changed();
}

}  // namespace

bool take_clip_handles(const Styling& model) {
    gi::Clip& clip = model.view.scene.look.clip;
    LookModel& tools = model.look;
    if (!tools.show_handles || !clip.active() || !model.view.picture) {
        tools.held.reset();
        return false;
    }
    for (const gi::ClipBox& box : clip.boxes) draw_edges(*model.view.picture, box);
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool free = !ImGui::GetIO().WantCaptureMouse;
    const float radius = scaled(kHandle);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) tools.held.reset();
    std::optional<ClipHandle> under;
    const auto handles = clip_handles(clip);
    if (tools.held && std::find(handles.begin(), handles.end(), *tools.held) == handles.end())
        tools.held.reset();
    for (const ClipHandle& handle : handles) {
        const auto at = on_screen(*model.view.picture, handle_place(clip, handle).position);
        if (!at) continue;
        const float x = at->x - mouse.x, y = at->y - mouse.y;
        const bool hovered = free && x * x + y * y < 4 * radius * radius;
        if (hovered) under = handle;
        const bool lit = tools.held ? *tools.held == handle : hovered;
        ImDrawList& list = *ImGui::GetBackgroundDrawList();
        if (!handle.plane && handle.face == ClipHandle::kCorner)  // a ring marks a handle that turns the box
            list.AddCircle(*at, radius, lit ? kHeld : kFace, 0, scaled(3));
        else
            list.AddCircleFilled(*at, radius, lit ? kHeld : kFace);
    }
    if (under && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) tools.held = under;
    if (tools.held) drag(model, *tools.held);
    return tools.held.has_value();
}

}  // namespace lucarne::viewer
