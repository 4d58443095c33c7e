#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

using Wish = ShowModel::Wish;

template <Wish kWish>
void wish(ViewModel& model) {
    model.show.wish = kWish;
}
bool has_picture(const ViewModel& model) {
    return model.picture != nullptr;
}
bool has_keys(const ViewModel& model) {
    return !model.show.editor.empty();
}
bool has_selected(const ViewModel& model) {
    return model.show.editor.selected().has_value();
}
bool can_undo(const ViewModel& model) {
    return model.show.editor.can_undo();
}
bool is_rendering(const ViewModel& model) {
    return model.show.rendering.running;
}

void add_key(ViewModel& model) {
    model.side_bar().unfold(BarSection::flythrough);
    model.show.add_key(model.rig.camera());
}
void replace_key(ViewModel& model) {
    model.show.take(model.show.editor.replace(model.rig.camera()));
}
void remove_key(ViewModel& model) {
    model.show.take(model.show.editor.remove());
}
template <int kBy>
void move_key(ViewModel& model) {
    model.show.take(model.show.editor.move(kBy));
}
/// Selects the key frame `kBy` places further; wraps around at the ends.
template <int kBy>
void select_key(ViewModel& model) {
    ShowModel& show = model.show;
    const size_t count = show.editor.path().keys.size();
    show.playing = false;
    show.go_to_key((show.editor.selected().value_or(0) + count + kBy) % count);
}

}  // namespace

std::span<const Action> show_actions() {
    static constexpr const char* kMenu = "Flythrough";
    static constexpr int kShift = GLFW_MOD_SHIFT, kCtrl = GLFW_MOD_CONTROL, kAlt = GLFW_MOD_ALT;
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_F12, kCtrl}, "Picture", "Save it in any size", wish<Wish::picture>, has_picture},
        Action{{GLFW_KEY_T, kShift},
               "Picture",
               "Transparent where no point is",
               [](ViewModel& m) { m.show.finish.transparent = !m.show.finish.transparent; },
               nullptr,
               [](const ViewModel& m) { return m.show.finish.transparent; }},
        Action{{GLFW_KEY_BACKSPACE, kAlt}, "Picture", "Cancel rendering", wish<Wish::cancel>, is_rendering},
        Action{{GLFW_KEY_INSERT}, kMenu, "Add this view", add_key, has_picture},
        Action{
            {GLFW_KEY_INSERT, kShift}, kMenu, "Replace the selected by this view", replace_key, has_selected},
        Action{{GLFW_KEY_DELETE, kShift}, kMenu, "Delete the selected", remove_key, has_selected},
        Action{{GLFW_KEY_LEFT, kAlt}, kMenu, "Select the one before", select_key<-1>, has_keys},
        Action{{GLFW_KEY_RIGHT, kAlt}, kMenu, "Select the next", select_key<1>, has_keys},
        Action{
            {GLFW_KEY_LEFT, kAlt | kShift}, kMenu, "Move the selected earlier", move_key<-1>, has_selected},
        Action{{GLFW_KEY_RIGHT, kAlt | kShift}, kMenu, "Move the selected later", move_key<1>, has_selected},
        Action{
            {GLFW_KEY_Z, kAlt | kShift}, kMenu, "Undo", [](ViewModel& m) { m.show.editor.undo(); }, can_undo},
        Action{{GLFW_KEY_SPACE},
               kMenu,
               "Play",
               [](ViewModel& m) { m.show.play(); },
               has_keys,
               [](const ViewModel& m) { return m.show.playing; }},
        Action{{GLFW_KEY_P, kAlt},
               kMenu,
               "Draw the path",
               [](ViewModel& m) { m.show.draw_path = !m.show.draw_path; },
               nullptr,
               [](const ViewModel& m) { return m.show.draw_path; }},
        Action{{GLFW_KEY_S, kAlt}, kMenu, "Save the path", wish<Wish::save_path>, has_keys},
        Action{{GLFW_KEY_O, kAlt | kShift}, kMenu, "Load the path", wish<Wish::load_path>, has_picture},
        Action{{GLFW_KEY_F11, kShift}, kMenu, "Render PNG frames", wish<Wish::frames>, has_keys},
        Action{{GLFW_KEY_F11, kCtrl}, kMenu, "Render a video", wish<Wish::video>, has_keys},
    };
    return kActions;
}

}  // namespace lucarne::viewer
