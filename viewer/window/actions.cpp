#include "viewer/window/actions.h"

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

std::vector<Action> join() {
    std::vector<Action> all;
    for (const auto room :
         {file_actions(), view_actions(), bookmark_actions(), look_actions(), light_actions(),
          picture_actions(), measure_actions(), show_actions(), window_actions()})
        all.insert(all.end(), room.begin(), room.end());
    return all;
}

}  // namespace

std::string key_text(const KeyChord& chord) {
    return fmt::format("{}{}{}{}", chord.modifiers & GLFW_MOD_CONTROL ? "Ctrl+" : "",
                       chord.modifiers & GLFW_MOD_ALT ? "Alt+" : "",
                       chord.modifiers & GLFW_MOD_SHIFT ? "Shift+" : "", key_name(chord.key));
}

const std::vector<Action>& actions() {
    static const std::vector<Action> kAll = join();
    return kAll;
}

void run_actions(ViewModel& model, std::span<const KeyChord> chords) {
    for (const KeyChord& chord : chords)
        for (const Action& action : actions())
            if (action.chord == chord && (!action.enabled || action.enabled(model))) action.run(model);
}

std::span<const Gesture> gestures() {
    static constexpr std::array kGestures = {
        Gesture{"left drag",
                "turn around the point under the cursor (orbit), around the pivot (turntable); look around "
                "(fly, walk)"},
        Gesture{"right or middle drag", "shift the view"},
        Gesture{"scroll", "go to the point under the cursor (orbit, turntable); speed (fly, walk)"},
        Gesture{"double-click", "choose the point to turn around"},
        Gesture{"W A S D, E Q", "fly or walk; with Shift faster"},
        Gesture{"click", "measure the point there, with a tool; select what a label belongs to"},
        Gesture{"left drag on a clip's handle", "move the box's face, or the plane; the ring turns the box"},
        Gesture{"left drag on a light's handle", "move it, or what it shines at; a sun about the scene"},
        Gesture{"left drag on an end of the legend's bar",
                "other values for its colours; double-click: where most values lie"},
        Gesture{"left drag on a comparison's border", "show more of one engine"},
        Gesture{"Shift + left drag", "aim the light at the point under the cursor"},
        Gesture{"Shift + right drag", "move the light sideways"},
    };
    return kGestures;
}

}  // namespace lucarne::viewer
