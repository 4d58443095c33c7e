// Draws a flythrough's path over the picture.
#include <imgui.h>

#include "viewer/measure/marks_layout.h"
#include "viewer/publish/publishing.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostPlaces = 1000;  ///< along the path
constexpr int kPieces = 2;            ///< of the line between two places, each visible or hidden
constexpr ImU32 kPath = IM_COL32(255, 140, 60, 255), kSelected = IM_COL32(90, 230, 255, 255);
constexpr float kDimmed = 0.35f;  ///< opacity of what a surface hides

ImVec2 at(const glm::dvec2& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y)};
}

ImU32 shade(ImU32 colour, bool hidden) {
    ImVec4 rgba = ImGui::ColorConvertU32ToFloat4(colour);
    if (hidden) rgba.w *= kDimmed;
    return ImGui::ColorConvertFloat4ToU32(rgba);
}

}  // namespace

void draw_flythrough(const Publishing& model) {
    const PublishModel& publish = model.publish;
    // Not drawn while it plays, because the path would run through the eye.
    if (!publish.draw_path || publish.playing || publish.editor.empty() || !model.view.picture) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    Overlay overlay;
    OverlayLayout layout(*model.view.picture, {display.x, display.y}, overlay);
    const auto places = places_along(publish.editor.path(), kMostPlaces);
    for (size_t i = 1; i < places.size(); ++i) layout.line(places[i - 1], places[i], 0, kPieces);
    const auto& keys = publish.editor.path().keys;
    for (size_t i = 0; i < std::min(keys.size(), kMostPlaces); ++i) {
        layout.mark(keys[i].camera.position, i);
        layout.label(keys[i].camera.position, std::to_string(i + 1), i);
    }
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const OverlayLine& line : overlay.lines)
        list.AddLine(at(line.from), at(line.to), shade(kPath, line.hidden), 2);
    const auto colour = [&](size_t key) { return publish.editor.selected() == key ? kSelected : kPath; };
    for (const OverlayMark& mark : overlay.marks)
        list.AddCircleFilled(at(mark.at), 5, shade(colour(mark.measurement), mark.hidden), 4);  // a diamond
    for (const OverlayLabel& label : overlay.labels)
        list.AddText(at(label.at + glm::dvec2(7, -ImGui::GetTextLineHeight())),
                     shade(colour(label.measurement), label.hidden), label.text.c_str());
}

}  // namespace lucarne::viewer
