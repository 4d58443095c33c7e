#include <algorithm>
#include <iterator>

#include <glm/geometric.hpp>
#include <imgui.h>

#include "viewer/overlay/figure_scale.h"
#include "viewer/style/overlay_view.h"
#include "viewer/style/styling.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

ImU32 packed(const Mark& mark) {
    return ImGui::ColorConvertFloat4ToU32(ImVec4(mark.colour.x, mark.colour.y, mark.colour.z, mark.opacity));
}
ImVec2 point(const glm::dvec2& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

}  // namespace

OverlayView overlay_view(const Styling& model) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    OverlayView view;
    view.camera = model.view.rig.camera();
    view.distance = glm::dot(model.view.rig.pivot() - model.view.rig.position(), model.view.rig.forward());
    view.metres_per_unit = model.view.picture->metres_per_unit;
    view.size = {static_cast<uint32_t>(size.x), static_cast<uint32_t>(size.y)};
    view.font = ImGui::GetFontSize();
    view.left = model.view.side_bar.pixels(view.font, size.x) + 8;
    view.right = 8;
    view.bottom = 2 * view.font;  // room for the line of messages
    return view;
}

void draw_overlay(const Styling& model) {
    if (!model.view.picture) return;
    const OverlayView view = overlay_view(model);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::vector<Mark> marks = overlay(model.view.scene.look, model.view.picture->values, view);
    std::ranges::move(figure_scale(model.view.scene, model.view.picture->exposure_ev, view),
                      std::back_inserter(marks));
    for (const Mark& mark : marks) {
        if (mark.kind == Mark::Kind::area) list.AddRectFilled(point(mark.from), point(mark.to), packed(mark));
        if (mark.kind == Mark::Kind::line)
            list.AddLine(point(mark.from), point(mark.to), packed(mark), scaled(2));
        if (mark.kind == Mark::Kind::text) list.AddText(point(mark.from), packed(mark), mark.text.c_str());
    }
}

}  // namespace lucarne::viewer
