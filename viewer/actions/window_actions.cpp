#include <algorithm>
#include <array>
#include <cstdlib>

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
void toggle_scans(ViewModel& model) {
    model.shell.show_scans = !model.shell.show_scans;
}
bool shows_scans(const ViewModel& model) {
    return model.shell.show_scans;
}

void toggle_controller(ViewModel& model) {
    model.controller.show_panel = !model.controller.show_panel;
}
bool shows_controller(const ViewModel& model) {
    return model.controller.show_panel;
}

void reload_shaders(ViewModel& model) {
    ++model.health.shader_version;
    model.message = "shader files are read again";
}
bool has_shader_files(const ViewModel&) {
    return std::getenv("LUCARNE_SHADERS") != nullptr;
}

constexpr double kTextStep = 1.1;
void scale_text(ViewModel& model, double by) {
    double& size = model.shell.settings.text_size;
    size = std::clamp(size * by, 0.5, 4.0);
}
void larger_text(ViewModel& model) {
    scale_text(model, kTextStep);
}
void smaller_text(ViewModel& model) {
    scale_text(model, 1 / kTextStep);
}

}  // namespace

std::span<const Action> window_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_TAB}, "Window", "Panels", toggle_panels, nullptr, shows_panels},
        Action{{GLFW_KEY_TAB, GLFW_MOD_SHIFT}, "Window", "Scans", toggle_scans, nullptr, shows_scans},
        Action{{GLFW_KEY_F6}, "Window", "6-DoF controller", toggle_controller, nullptr, shows_controller},
        Action{{GLFW_KEY_EQUAL, GLFW_MOD_CONTROL}, "Window", "Larger text", larger_text},
        Action{{GLFW_KEY_MINUS, GLFW_MOD_CONTROL}, "Window", "Smaller text", smaller_text},
        Action{{GLFW_KEY_F5, GLFW_MOD_CONTROL}, "Window", "Read shader files again", reload_shaders,
               has_shader_files},
        Action{{GLFW_KEY_F1}, "Help", "Keys and mouse", toggle_help, nullptr, shows_help},
    };
    return kActions;
}

}  // namespace lucarne::viewer
