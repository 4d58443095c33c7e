#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/actions.h"

namespace lucarne::viewer {
namespace {

void save_picture(ViewModel& model) {
    model.save_picture = true;
}
bool has_picture(const ViewModel& model) {
    return model.picture != nullptr;
}
void close(ViewModel& model) {
    model.close = true;
}

}  // namespace

std::span<const Action> file_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_F12}, "File", "Save the picture as PNG", save_picture, has_picture},
        Action{{GLFW_KEY_Q, GLFW_MOD_CONTROL}, "File", "Quit", close},
    };
    return kActions;
}

}  // namespace lucarne::viewer
