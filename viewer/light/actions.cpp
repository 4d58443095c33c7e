#include <algorithm>
#include <array>
#include <cmath>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "viewer/light/edits.h"
#include "viewer/window/actions.h"

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

template <gi::LightKind Kind>
void add(ViewModel& model) {
    add_light(model, Kind);
}
bool is_on(const ViewModel& model) {
    return has_light(model) && model.light < model.scene.lights.size() && model.scene.lights[model.light].on;
}
bool can_undo(const ViewModel& model) {
    return !model.light_tools.undo.empty();
}
void toggle_handles(ViewModel& model) {
    model.light_tools.show_handles = !model.light_tools.show_handles;
}
bool shows_handles(const ViewModel& model) {
    return model.light_tools.show_handles;
}

}  // namespace

std::span<const Action> light_actions() {
    using Kind = gi::LightKind;
    static constexpr int kAltShift = GLFW_MOD_ALT | GLFW_MOD_SHIFT;
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_L}, "Light", "Put the light where the camera is", place_light_at_camera, has_light},
        Action{{GLFW_KEY_N}, "Light", "Select the next light", next_light, has_light},
        Action{{GLFW_KEY_O, GLFW_MOD_ALT}, "Light", "On", switch_selected_light, has_light, is_on},
        Action{{GLFW_KEY_1, kAltShift}, "Light/Add", "Spot", add<Kind::spot>},
        Action{{GLFW_KEY_2, kAltShift}, "Light/Add", "Point", add<Kind::point>},
        Action{{GLFW_KEY_3, kAltShift}, "Light/Add", "Sun", add<Kind::directional>},
        Action{{GLFW_KEY_4, kAltShift}, "Light/Add", "Rectangle", add<Kind::rectangle>},
        Action{{GLFW_KEY_5, kAltShift}, "Light/Add", "Disc", add<Kind::disc>},
        Action{{GLFW_KEY_D, GLFW_MOD_ALT}, "Light", "Duplicate", duplicate_light, has_light},
        Action{{GLFW_KEY_DELETE, GLFW_MOD_ALT}, "Light", "Delete", remove_light, has_light},
        Action{{GLFW_KEY_Z, GLFW_MOD_ALT}, "Light", "Undo", undo_lights, can_undo},
        Action{{GLFW_KEY_H, GLFW_MOD_ALT}, "Light", "Handles", toggle_handles, nullptr, shows_handles},
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
                                  model.scene_size / 100);  // so that a light at the camera moves
    const double height = 2 * std::tan(camera.vertical_fov / 2) * depth;
    const glm::dvec3 step = (model.rig.right() * shift.x + model.rig.up() * shift.y) * height;
    light->position += step;
    light->target += step;
    model.scene_changed();
}

}  // namespace lucarne::viewer
