#include <algorithm>
#include <array>
#include <cstdlib>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/window/actions/actions.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<ViewModel>;

void toggle_help(ViewModel& model) {
    model.show_help = !model.show_help;
}
bool shows_help(const ViewModel& model) {
    return model.show_help;
}
void toggle_about(ViewModel& model) {
    model.show_about = !model.show_about;
}
bool shows_about(const ViewModel& model) {
    return model.show_about;
}
void toggle_side_bar(ViewModel& model) {
    model.view.side_bar.shown = !model.view.side_bar.shown;
}
bool shows_side_bar(const ViewModel& model) {
    return model.view.side_bar.shown;
}

template <BarSection Of>
constexpr Entry section(KeyChord key, const char* name) {
    return {key,     "Window",
            name,    [](ViewModel& model) { model.view.side_bar.toggle(Of); },
            nullptr, [](const ViewModel& model) { return model.view.side_bar.shows(Of); }};
}

void reload_shaders(ViewModel& model) {
    ++model.health.shader_version;
    model.view.message = "shader files are read again";
}

constexpr double kTextStep = 1.1;
void scale_text(ViewModel& model, double by) {
    double& size = model.settings.text_size;
    size = std::clamp(size * by, 0.5, 4.0);
}
void larger_text(ViewModel& model) {
    scale_text(model, kTextStep);
}
void smaller_text(ViewModel& model) {
    scale_text(model, 1 / kTextStep);
}

}  // namespace

std::span<const Action<ViewModel>> window_actions() {
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_TAB}, "Window", "Side bar", toggle_side_bar, nullptr, shows_side_bar},
        section<BarSection::scans>({GLFW_KEY_TAB, GLFW_MOD_SHIFT}, "Scans"),
        section<BarSection::rendering>({GLFW_KEY_F7}, "Rendering"),
        section<BarSection::look>({GLFW_KEY_Y}, "Appearance"),
        section<BarSection::light>({GLFW_KEY_L, GLFW_MOD_ALT}, "Light"),
        section<BarSection::measure>({GLFW_KEY_M}, "Measure"),
        section<BarSection::bookmarks>({GLFW_KEY_B, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT}, "Bookmarks"),
        section<BarSection::flythrough>({GLFW_KEY_P, GLFW_MOD_SHIFT}, "Flythrough"),
        section<BarSection::picture>({GLFW_KEY_F12, GLFW_MOD_SHIFT}, "Save a picture"),
        section<BarSection::statistics>({GLFW_KEY_F8}, "Statistics"),
        section<BarSection::controller>({GLFW_KEY_F6}, "6-DoF controller"),
        section<BarSection::preferences>({GLFW_KEY_F9}, "Preferences"),
        Entry{{GLFW_KEY_EQUAL, GLFW_MOD_CONTROL}, "Window", "Larger text", larger_text},
        Entry{{GLFW_KEY_MINUS, GLFW_MOD_CONTROL}, "Window", "Smaller text", smaller_text},
        Entry{{GLFW_KEY_F1}, "Help", "Keys and mouse", toggle_help, nullptr, shows_help},
        Entry{{GLFW_KEY_F1, GLFW_MOD_SHIFT}, "Help", "About Lucarne", toggle_about, nullptr, shows_about},
        // For those who write shaders: the last one, which others do not see.
        Entry{{GLFW_KEY_F5, GLFW_MOD_CONTROL}, "Window", "Read shader files again", reload_shaders},
    };
    return std::span(kActions).first(kActions.size() - (std::getenv("LUCARNE_SHADERS") ? 0 : 1));
}

}  // namespace lucarne::viewer
