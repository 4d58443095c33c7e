#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/actions.h"

namespace lucarne::viewer {
namespace {

void go_home(ViewModel& model) {
    model.rig = CameraRig(model.home);
}

void toggle_flying(ViewModel& model) {
    const bool flying = model.navigation.mode() == NavigationMode::fly;
    model.navigation.set_mode(flying ? NavigationMode::orbit : NavigationMode::fly);
    model.message = flying ? "orbiting" : "flying: W A S D, E and Q for up and down";
}

bool flies(const ViewModel& model) {
    return model.navigation.mode() == NavigationMode::fly;
}

}  // namespace

std::span<const Action> view_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_HOME}, "View", "Back to the first view", go_home},
        Action{{GLFW_KEY_F}, "View/Navigation", "Fly", toggle_flying, nullptr, flies},
    };
    return kActions;
}

}  // namespace lucarne::viewer
