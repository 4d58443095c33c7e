// The panel for saving pictures of any size under a chosen name.
#include <algorithm>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/publish/publishing.h"
#include "viewer/publish/render_progress.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {

void draw_picture_panel(const Publishing& model) {
    PublishModel& publish = model.publish;
    size_fields("Size", publish.width, publish.height);
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (ImGui::Button("the window's size")) {
        publish.width = static_cast<int>(display.x);
        publish.height = static_cast<int>(display.y);
    }
    ImGui::InputInt(LeftLabel("Frames"), &publish.frames);
    publish.frames = std::clamp(publish.frames, 1, kMostAveraged);
    ImGui::Checkbox("Transparent background", &publish.finish.transparent);
    ImGui::Checkbox("Legend, axes and scale bar", &publish.finish.overlays);
    ImGui::InputText(LeftLabel("File"), &publish.picture_file);
    if (render_progress(publish) && ImGui::Button("Save")) publish.commands.push(RenderPicture{});
}

}  // namespace lucarne::viewer
