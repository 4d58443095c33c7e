#include <algorithm>
#include <array>
#include <cmath>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "viewer/actions.h"

namespace lucarne::viewer {
namespace {

void next_light(ViewModel& model) {
    if (model.scene.lights.empty()) return;
    model.light = (model.light + 1) % model.scene.lights.size();
    model.message = fmt::format("light {} selected", model.light + 1);
}

bool has_light(const ViewModel& model) {
    return !model.scene.lights.empty();
}

}  // namespace

std::span<const Action> light_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_L}, "Light", "Put the light where the camera is", place_light_at_camera, has_light},
        Action{{GLFW_KEY_N}, "Light", "Select the next light", next_light, has_light},
    };
    return kActions;
}

void place_light_at_camera(ViewModel& model) {
    gi::SceneLight* light = model.selected_light();
    if (!light) {
        model.message = "the scene has no light to place";
        return;
    }
    const gi::SceneCamera camera = model.rig.camera();
    light->position = camera.position;
    light->target = camera.target;
    model.scene_changed();
    model.message = "the light is where the camera is";
}

void aim_light(ViewModel& model, const glm::dvec3& target) {
    gi::SceneLight* light = model.selected_light();
    if (!light || glm::distance(light->position, target) < 1e-6 * model.scene_size) return;
    light->target = target;
    model.scene_changed();
}

void shift_light(ViewModel& model, const glm::dvec2& shift) {
    gi::SceneLight* light = model.selected_light();
    if (!light) return;
    const gi::SceneCamera camera = model.rig.camera();
    const double depth = std::max(std::abs(glm::dot(light->position - camera.position, model.rig.forward())),
                                  model.scene_size / 100);  // a light beside the camera moves as well
    const double height = 2 * std::tan(camera.vertical_fov / 2) * depth;
    const glm::dvec3 step = (model.rig.right() * shift.x + model.rig.up() * shift.y) * height;
    light->position += step;
    light->target += step;
    model.scene_changed();
}

}  // namespace lucarne::viewer
