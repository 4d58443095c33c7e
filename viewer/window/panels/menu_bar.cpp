#include <imgui.h>

#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

/// Begins the menu of a title in the menu bar. ImGui opens it when the mouse passes over the title while
/// another menu is open, and closes an open one when its title is clicked. So a click would close what the
/// mouse has just opened; here only a second click closes it.
bool begin_title(const char* title) {
    const ImGuiID own = ImGui::GetID(title);
    ImGuiStorage& storage = *ImGui::GetStateStorage();
    const ImGuiID key = ImGui::GetID("clicked title");
    const bool clicked_before = static_cast<ImGuiID>(storage.GetInt(key)) == own;
    const bool was_open = ImGui::IsPopupOpen(title), clicks = ImGui::IsMouseClicked(ImGuiMouseButton_Left);
    const bool open = ImGui::BeginMenu(title);
    const bool opens = !was_open && open, closes = was_open && !open && clicks;
    if (opens || closes)
        storage.SetInt(key, clicks && !(closes && clicked_before) ? static_cast<int>(own) : 0);
    if (closes && !clicked_before && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenBlockedByPopup))
        ImGui::OpenPopup(title);
    return open;
}

/// Opens the nested menus of a path, calls `inside` in the innermost one, and closes them. A menu that was
/// opened before in the same frame is extended.
template <class Inside>
void in_menu(std::string_view path, const Inside& inside, bool (*begin)(const char*) = begin_title) {
    const size_t slash = path.find('/');
    const std::string outer(path.substr(0, slash));
    if (!begin(outer.c_str())) return;
    if (slash == std::string_view::npos)
        inside();
    else
        in_menu(path.substr(slash + 1), inside, [](const char* name) { return ImGui::BeginMenu(name); });
    ImGui::EndMenu();
}

}  // namespace

void draw_menu_bar(ViewModel& model, std::span<const BoundAction> actions) {
    if (!ImGui::BeginMainMenuBar()) return;
    for (const BoundAction& action : actions)
        in_menu(action.menu, [&] {
            if (ImGui::MenuItem(action.name, key_text(action.chord).c_str(), action.checked(),
                                action.enabled()))
                action.run();
        });
    in_menu("File", [&] {
        const auto& recent = model.settings.recent;
        if (!ImGui::BeginMenu("Recent", !recent.empty())) return;
        for (const std::string& path : recent)
            if (ImGui::MenuItem(path.c_str())) model.scan_commands.push(OpenFiles{{path}});
        ImGui::EndMenu();
    });
    ImGui::EndMainMenuBar();
}

}  // namespace lucarne::viewer
