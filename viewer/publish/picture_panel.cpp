// The panel for saving pictures of any size under a chosen name.
#include <algorithm>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/publish/publishing.h"
#include "viewer/publish/render_progress.h"

namespace lucarne::viewer {

void draw_picture_panel(const Publishing& model) {
    PublishModel& show = model.publish;
    size_fields("size", show.width, show.height);
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (ImGui::Button("the window's size")) {
        show.width = static_cast<int>(display.x);
        show.height = static_cast<int>(display.y);
    }
    ImGui::InputInt("averaged", &show.frames);
    show.frames = std::clamp(show.frames, 1, kMostAveraged);
    ImGui::Checkbox("transparent where no point is", &show.finish.transparent);
    ImGui::Checkbox("legend, axes and scale bar", &show.finish.overlays);
    ImGui::InputText("file", &show.picture_file);
    if (render_progress(show) && ImGui::Button("Save")) show.commands.push(RenderPicture{});
}

}  // namespace lucarne::viewer
