#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/actions.h"

namespace lucarne::viewer {
namespace {

void toggle_help(ViewModel& model) {
    model.show_help = !model.show_help;
}
bool shows_help(const ViewModel& model) {
    return model.show_help;
}
void toggle_panels(ViewModel& model) {
    model.show_panels = !model.show_panels;
}
bool shows_panels(const ViewModel& model) {
    return model.show_panels;
}

}  // namespace

std::span<const Action> window_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_TAB}, "Window", "Panels", toggle_panels, nullptr, shows_panels},
        Action{{GLFW_KEY_F1}, "Help", "Keys and mouse", toggle_help, nullptr, shows_help},
    };
    return kActions;
}

}  // namespace lucarne::viewer
