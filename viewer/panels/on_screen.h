#pragma once

#include <optional>

#include <imgui.h>

#include "viewer/tools/pick.h"

namespace lucarne::viewer {

/// Where a world point stands in the window; none where it is behind the camera.
inline std::optional<ImVec2> on_screen(const Picture& picture, const glm::dvec3& world) {
    const auto seen = project(picture, world);
    if (!seen) return std::nullopt;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    return ImVec2(static_cast<float>(seen->pixel.x / picture.size.width) * size.x,
                  static_cast<float>(seen->pixel.y / picture.size.height) * size.y);
}

}  // namespace lucarne::viewer
