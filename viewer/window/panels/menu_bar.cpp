#include <imgui.h>

#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

/// Opens the nested menus of a path, calls `inside` in the innermost one, and closes them. A menu that was
/// opened before in the same frame is extended.
template <class Inside>
void in_menu(std::string_view path, const Inside& inside) {
    const size_t slash = path.find('/');
    const std::string outer(path.substr(0, slash));
    if (!ImGui::BeginMenu(outer.c_str())) return;
    if (slash == std::string_view::npos)
        inside();
    else
        in_menu(path.substr(slash + 1), inside);
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
