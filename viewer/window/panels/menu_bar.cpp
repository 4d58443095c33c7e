#include <imgui.h>

#include "viewer/window/actions.h"
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

void draw_menu_bar(ViewModel& model) {
    if (!ImGui::BeginMainMenuBar()) return;
    for (const Action& action : actions())
        in_menu(action.menu, [&] {
            const bool checked = action.checked && action.checked(model);
            const bool enabled = !action.enabled || action.enabled(model);
            if (ImGui::MenuItem(action.name, key_text(action.chord).c_str(), checked, enabled))
                action.run(model);
        });
    in_menu("File", [&] {
        const auto& recent = model.shell.settings.recent;
        if (!ImGui::BeginMenu("Opened before", !recent.empty())) return;
        for (const std::string& path : recent)
            if (ImGui::MenuItem(path.c_str())) model.shell.to_open = {path};
        ImGui::EndMenu();
    });
    ImGui::EndMainMenuBar();
}

}  // namespace lucarne::viewer
