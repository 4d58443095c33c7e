#include <imgui.h>

#include "viewer/bookmarks/bookmarking.h"

namespace lucarne::viewer {

void draw_bookmarks_panel(const Bookmarking& model) {
    BookmarkModel& bookmarks = model.bookmarks;
    const float font = ImGui::GetFontSize();
    size_t gone = bookmarks.all.size();
    if (bookmarks.all.empty()) ImGui::TextWrapped("Ctrl+B sets one where you are.");
    for (size_t i = 0; i < bookmarks.all.size(); ++i) {
        Bookmark& bookmark = bookmarks.all[i];
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
            chosen = ImGui::Button("Go there", ImVec2(8 * font, height));
        ImGui::SameLine();
        ImGui::BeginGroup();
        ImGui::TextUnformatted(bookmark.camera.name.c_str());
        if (ImGui::SmallButton("Remove")) gone = i;
        ImGui::EndGroup();
        if (chosen) {
            bookmarks.visited = i;
            model.view.go_to(bookmark.camera);
        }
        ImGui::PopID();
    }
    if (gone >= bookmarks.all.size()) return;
    if (bookmarks.all[gone].texture) bookmarks.commands.push(FreeThumbnail{bookmarks.all[gone].texture});
    bookmarks.all.erase(bookmarks.all.begin() + static_cast<std::ptrdiff_t>(gone));
    bookmarks.commands.push(SaveBookmarks{});
}

}  // namespace lucarne::viewer
