#pragma once

#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "viewer/publish/model.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {

inline constexpr int kLargestPicture = 16384;  ///< pixels along a side
inline constexpr int kMostAveraged = 65536;    ///< frames

/// Draws fields for a picture's width and height.
inline void size_fields(const char* label, int& width, int& height) {
    int both[2] = {width, height};
    ImGui::InputInt2(LeftLabel(label), both);
    width = std::clamp(both[0], 1, kLargestPicture);
    height = std::clamp(both[1], 1, kLargestPicture);
}

/// Draws the progress of rendering and a button to cancel it. Returns true if nothing is being rendered.
inline bool render_progress(PublishModel& publish) {
    const RenderState& state = publish.rendering;
    if (!state.running) return true;
    const float share = static_cast<float>(state.done) / static_cast<float>(std::max<size_t>(state.total, 1));
    ImGui::ProgressBar(share, ImVec2(14 * ImGui::GetFontSize(), 0),
                       fmt::format("{} of {} frames", state.done, state.total).c_str());
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) publish.commands.push(CancelRendering{});
    return false;
}

}  // namespace lucarne::viewer
