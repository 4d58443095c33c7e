#pragma once

#include <string>

namespace lucarne::viewer {

/// A key with what is held down beside it.
struct KeyChord {
    int key = 0;        ///< as GLFW numbers it
    int modifiers = 0;  ///< GLFW_MOD_SHIFT, GLFW_MOD_CONTROL, GLFW_MOD_ALT, or together
    bool operator==(const KeyChord&) const = default;
};
/// "Ctrl+Shift+O".
std::string key_text(const KeyChord& chord);

}  // namespace lucarne::viewer
