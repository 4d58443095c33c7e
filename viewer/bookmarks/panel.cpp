#include <imgui.h>

#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {

void draw_bookmarks_panel(ViewModel& model) {
    Shell& shell = model.shell;
    const float font = ImGui::GetFontSize();
    size_t gone = shell.bookmarks.size();
    if (shell.bookmarks.empty()) ImGui::TextWrapped("Ctrl+B sets one where you are.");
    for (size_t i = 0; i < shell.bookmarks.size(); ++i) {
        Bookmark& bookmark = shell.bookmarks[i];
        ImGui::PushID(static_cast<int>(i));
        const float height = 4.5f * font;
        const float width = bookmark.thumbnail.height
                                ? height * static_cast<float>(bookmark.thumbnail.width) /
                                      static_cast<float>(bookmark.thumbnail.height)
                                : 0;
        bool chosen = false;
        if (bookmark.texture)
            chosen =
                ImGui::ImageButton(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(bookmark.texture)),
                                   ImVec2(width, height));
        else
            chosen = ImGui::Button("go there", ImVec2(8 * font, height));
        ImGui::SameLine();
        ImGui::BeginGroup();
        ImGui::TextUnformatted(bookmark.camera.name.c_str());
        if (ImGui::SmallButton("remove")) gone = i;
        ImGui::EndGroup();
        if (chosen) {
            shell.bookmark = i;
            model.go_to(bookmark.camera);
        }
        ImGui::PopID();
    }
    if (gone >= shell.bookmarks.size()) return;
    if (shell.bookmarks[gone].texture) shell.stale_textures.push_back(shell.bookmarks[gone].texture);
    shell.bookmarks.erase(shell.bookmarks.begin() + static_cast<std::ptrdiff_t>(gone));
    shell.bookmarks_changed = true;
}

}  // namespace lucarne::viewer
