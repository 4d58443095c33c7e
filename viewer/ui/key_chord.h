#pragma once

#include <string>

namespace lucarne::viewer {

/// A key and its modifiers.
struct KeyChord {
    int key = 0;        ///< GLFW's key code
    int modifiers = 0;  ///< GLFW_MOD_SHIFT, GLFW_MOD_CONTROL, GLFW_MOD_ALT, or a combination
    bool operator==(const KeyChord&) const = default;
};
/// Returns a text such as "Ctrl+Shift+O".
std::string key_text(const KeyChord& chord);

}  // namespace lucarne::viewer
