#include "viewer/ui/key_chord.h"

#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lucarne::viewer {
namespace {

struct NamedKey {
    int key;
    const char* name;
};
constexpr std::array kNamedKeys = {
    NamedKey{GLFW_KEY_TAB, "Tab"},
    NamedKey{GLFW_KEY_HOME, "Home"},
    NamedKey{GLFW_KEY_END, "End"},
    NamedKey{GLFW_KEY_INSERT, "Insert"},
    NamedKey{GLFW_KEY_DELETE, "Delete"},
    NamedKey{GLFW_KEY_PAGE_UP, "Page up"},
    NamedKey{GLFW_KEY_PAGE_DOWN, "Page down"},
    NamedKey{GLFW_KEY_ESCAPE, "Escape"},
    NamedKey{GLFW_KEY_ENTER, "Enter"},
    NamedKey{GLFW_KEY_SPACE, "Space"},
    NamedKey{GLFW_KEY_BACKSPACE, "Backspace"},
    NamedKey{GLFW_KEY_UP, "Up"},
    NamedKey{GLFW_KEY_DOWN, "Down"},
    NamedKey{GLFW_KEY_LEFT, "Left"},
    NamedKey{GLFW_KEY_RIGHT, "Right"},
};

std::string key_name(int key) {
    if (key > GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT)
        return {static_cast<char>(key)};  // these codes are ASCII
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return fmt::format("F{}", key - GLFW_KEY_F1 + 1);
    for (const NamedKey& named : kNamedKeys)
        if (named.key == key) return named.name;
    return fmt::format("key {}", key);
}

}  // namespace

std::string key_text(const KeyChord& chord) {
    return fmt::format("{}{}{}{}", chord.modifiers & GLFW_MOD_CONTROL ? "Ctrl+" : "",
                       chord.modifiers & GLFW_MOD_ALT ? "Alt+" : "",
                       chord.modifiers & GLFW_MOD_SHIFT ? "Shift+" : "", key_name(chord.key));
}

}  // namespace lucarne::viewer
