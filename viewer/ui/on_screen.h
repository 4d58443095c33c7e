#pragma once

#include <algorithm>
#include <optional>

#include <imgui.h>

#include "viewer/camera/camera.h"
#include "viewer/picking/pick.h"
#include "viewer/ui/side_bar.h"

namespace lucarne::viewer {

inline constexpr float kTextPixels = 15;  ///< font height on a screen of scale 1, as it was designed

/// Returns a world point's place in the window, or nothing if it is behind the camera.
inline std::optional<ImVec2> on_screen(const Picture& picture, const glm::dvec3& world) {
    const auto seen = project(picture, world);
    if (!seen) return std::nullopt;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    return ImVec2(static_cast<float>(seen->pixel.x / picture.size.width) * size.x,
                  static_cast<float>(seen->pixel.y / picture.size.height) * size.y);
}

/// Returns the cursor in shares of the window's width and height.
inline glm::dvec2 cursor() {
    const ImGuiIO& io = ImGui::GetIO();
    return {io.MousePos.x / io.DisplaySize.x, io.MousePos.y / io.DisplaySize.y};
}

/// Returns the cursor's move in shares of the window's height.
inline glm::dvec2 cursor_move() {
    const ImGuiIO& io = ImGui::GetIO();
    return glm::dvec2(io.MouseDelta.x, io.MouseDelta.y) / static_cast<double>(io.DisplaySize.y);
}

/// Returns the ray through the cursor.
inline CameraRig::Ray cursor_ray(const CameraRig& rig) {
    const ImGuiIO& io = ImGui::GetIO();
    return rig.ray({2.0 * io.MousePos.x / io.DisplaySize.x - 1, 1 - 2.0 * io.MousePos.y / io.DisplaySize.y},
                   static_cast<double>(io.DisplaySize.x) / io.DisplaySize.y);
}

/// Returns a length for drawing over the picture: `dots` pixels on a screen of scale 1, scaled with the text.
inline float scaled(float dots) {
    return dots * ImGui::GetFontSize() / kTextPixels;
}

/// Returns the top and bottom of the bar of moods, pixels. Whether it is shown depends on the window's width.
inline ImVec2 mood_bar_span() {
    const float top = ImGui::GetFrameHeight() + scaled(6);
    return {top, top + ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().WindowPadding.y};
}

/// Returns the window's shape, and the part of it beside the side bar and below the bar of moods.
inline PictureShape picture_shape(const SideBar& side_bar) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    PictureShape shape{static_cast<double>(size.x) / size.y, {}};
    shape.free.left = -1 + 2 * side_bar.pixels(ImGui::GetFontSize(), size.x) / size.x;
    shape.free.top = std::max(0.5, 1 - 2 * static_cast<double>(mood_bar_span().y) / size.y);
    return shape;
}

/// Draws the dark plate on which texts over the picture are legible.
inline void draw_plate(ImDrawList& list, const ImVec2& from, const ImVec2& to, float rounding) {
    list.AddRectFilled(from, to, IM_COL32(10, 10, 10, 150), rounding);
}

}  // namespace lucarne::viewer
