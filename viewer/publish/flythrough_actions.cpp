#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/publish/publishing.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Publishing>;

template <class Command>
void push(const Publishing& model) {
    model.publish.commands.push(Command{});
}
bool has_picture(const Publishing& model) {
    return model.view.picture != nullptr;
}
bool has_keys(const Publishing& model) {
    return !model.publish.editor.empty();
}
bool has_selected(const Publishing& model) {
    return model.publish.editor.selected().has_value();
}
bool is_rendering(const Publishing& model) {
    return model.publish.rendering.running;
}

void add_key(const Publishing& model) {
    model.view.side_bar.unfold(BarSection::flythrough);
    model.publish.add_key(model.view.rig.camera());
}
void replace_key(const Publishing& model) {
    model.publish.take(model.publish.editor.replace(model.view.rig.camera()));
}
void remove_key(const Publishing& model) {
    model.publish.take(model.publish.editor.remove());
}
template <int kBy>
void move_key(const Publishing& model) {
    model.publish.take(model.publish.editor.move(kBy));
}
/// Selects the key frame `kBy` places further; wraps around at the ends.
template <int kBy>
void select_key(const Publishing& model) {
    PublishModel& publish = model.publish;
    const size_t count = publish.editor.path().keys.size();
    publish.playing = false;
    publish.go_to_key((publish.editor.selected().value_or(0) + count + kBy) % count);
}

}  // namespace

std::span<const Action<const Publishing>> publish_actions() {
    static constexpr const char* kMenu = "Flythrough";
    static constexpr int kShift = GLFW_MOD_SHIFT, kCtrl = GLFW_MOD_CONTROL, kAlt = GLFW_MOD_ALT;
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_F12, kCtrl}, "Picture", "Render picture", push<RenderPicture>, has_picture},
        Entry{{GLFW_KEY_T, kShift},
              "Picture",
              "Transparent background",
              [](const Publishing& m) { m.publish.finish.transparent = !m.publish.finish.transparent; },
              nullptr,
              [](const Publishing& m) { return m.publish.finish.transparent; }},
        Entry{{GLFW_KEY_BACKSPACE, kAlt}, "Picture", "Cancel rendering", push<CancelRendering>, is_rendering},
        Entry{{GLFW_KEY_INSERT}, kMenu, "Add this view", add_key, has_picture},
        Entry{
            {GLFW_KEY_INSERT, kShift}, kMenu, "Replace the selected by this view", replace_key, has_selected},
        Entry{{GLFW_KEY_DELETE, kShift}, kMenu, "Delete the selected", remove_key, has_selected},
        Entry{{GLFW_KEY_LEFT, kAlt}, kMenu, "Select the one before", select_key<-1>, has_keys},
        Entry{{GLFW_KEY_RIGHT, kAlt}, kMenu, "Select the next", select_key<1>, has_keys},
        Entry{{GLFW_KEY_LEFT, kAlt | kShift}, kMenu, "Move the selected earlier", move_key<-1>, has_selected},
        Entry{{GLFW_KEY_RIGHT, kAlt | kShift}, kMenu, "Move the selected later", move_key<1>, has_selected},
        Entry{{GLFW_KEY_SPACE},
              kMenu,
              "Play",
              [](const Publishing& m) { m.publish.play(); },
              has_keys,
              [](const Publishing& m) { return m.publish.playing; }},
        Entry{{GLFW_KEY_P, kAlt},
              kMenu,
              "Draw the path",
              [](const Publishing& m) { m.publish.draw_path = !m.publish.draw_path; },
              nullptr,
              [](const Publishing& m) { return m.publish.draw_path; }},
        Entry{{GLFW_KEY_S, kAlt}, kMenu, "Save the path", push<SavePath>, has_keys},
        Entry{{GLFW_KEY_O, kAlt | kShift}, kMenu, "Load the path", push<LoadPath>, has_picture},
        Entry{{GLFW_KEY_F11, kShift}, kMenu, "Render PNG frames", push<RenderFrames>, has_keys},
        Entry{{GLFW_KEY_F11, kCtrl}, kMenu, "Render a video", push<RenderVideo>, has_keys},
    };
    return kActions;
}

}  // namespace lucarne::viewer
