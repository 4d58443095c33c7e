#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/window/actions/actions.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<ViewModel>;

void undo(ViewModel& model) {
    model.history.undo(model);
}
bool can_undo(const ViewModel& model) {
    return model.history.can_undo();
}
void redo(ViewModel& model) {
    model.history.redo(model);
}
bool can_redo(const ViewModel& model) {
    return model.history.can_redo();
}

}  // namespace

std::span<const Action<ViewModel>> edit_actions() {
    static constexpr int kCtrl = GLFW_MOD_CONTROL;
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_Z, kCtrl}, "Edit", "Undo", undo, can_undo},
        Entry{{GLFW_KEY_Z, kCtrl | GLFW_MOD_SHIFT},
              "Edit",
              "Redo",
              redo,
              can_redo,
              nullptr,
              {GLFW_KEY_Y, kCtrl}},
    };
    return kActions;
}

}  // namespace lucarne::viewer
