#include "viewer/actions.h"

#define GLFW_INCLUDE_NONE
#include <algorithm>
#include <array>
#include <cmath>

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/registry.h"

namespace lucarne::viewer {
namespace {

constexpr double kExposureStep = 0.5;  ///< stops
constexpr uint32_t kMostBounces = 8;

void toggle_help(ViewModel& model) {
    model.show_help = !model.show_help;
}
void toggle_panels(ViewModel& model) {
    model.show_panels = !model.show_panels;
}
void save_picture(ViewModel& model) {
    model.save_picture = true;
}
void close(ViewModel& model) {
    model.close = true;
}
void go_home(ViewModel& model) {
    model.rig = CameraRig(model.home);
}

void toggle_flying(ViewModel& model) {
    const bool flying = model.navigation.mode() == NavigationMode::fly;
    model.navigation.set_mode(flying ? NavigationMode::orbit : NavigationMode::fly);
    model.message = flying ? "orbiting" : "flying: W A S D, E and Q for up and down";
}

void next_light(ViewModel& model) {
    if (model.scene.lights.empty()) return;
    model.light = (model.light + 1) % model.scene.lights.size();
    model.message = fmt::format("light {} selected", model.light + 1);
}

void next_engine(ViewModel& model) {
    const auto engines = gi::engines();
    const auto now =
        std::ranges::find(engines, model.engine, [](const auto& entry) { return entry.info.name; });
    const auto next = now == engines.end() || now + 1 == engines.end() ? engines.begin() : now + 1;
    model.engine = next->info.name;
    model.message = fmt::format("engine {}: {}", next->info.name, next->info.description);
}

void next_preset(ViewModel& model) {
    const auto all = presets();
    const auto now = std::ranges::find(all, model.preset, &Preset::name);
    const Preset& next = now == all.end() || now + 1 == all.end() ? all.front() : now[1];
    if (model.choose_preset(next.name))
        model.message = fmt::format("preset {}: {}", next.name, next.description);
}

void change_bounces(ViewModel& model, int by) {
    model.settings.bounces =
        static_cast<uint32_t>(std::clamp<int64_t>(int64_t{model.settings.bounces} + by, 0, kMostBounces));
    model.message =
        fmt::format("{} indirect bounce{}", model.settings.bounces, model.settings.bounces == 1 ? "" : "s");
}
void more_bounces(ViewModel& model) {
    change_bounces(model, 1);
}
void fewer_bounces(ViewModel& model) {
    change_bounces(model, -1);
}

void change_exposure(ViewModel& model, double stops) {
    const double now = model.scene.exposure_ev.value_or(model.picture ? model.picture->exposure_ev : 0.0);
    model.scene.exposure_ev = std::clamp(now + stops, -40.0, 40.0);
    model.scene_changed();
    model.message = fmt::format("exposure {:+.1f} stops", *model.scene.exposure_ev);
}
void brighter(ViewModel& model) {
    change_exposure(model, kExposureStep);
}
void darker(ViewModel& model) {
    change_exposure(model, -kExposureStep);
}
void automatic_exposure(ViewModel& model) {
    model.scene.exposure_ev.reset();
    model.scene_changed();
    model.message = "automatic exposure";
}

}  // namespace

Result<void> ViewModel::choose_preset(std::string_view name) {
    LUCARNE_ASSIGN(const Preset chosen, find_preset(name));
    const gi::EngineSettings before = settings;
    preset = chosen.name;
    settings = chosen.engine;
    budgets = chosen.budgets;
    // What is seen is the user's choice, not the preset's.
    settings.bounces = before.bounces;
    settings.only_bounce = before.only_bounce;
    settings.seed = before.seed;
    return {};
}

std::span<const Action> actions() {
    static constexpr std::array kActions = {
        Action{GLFW_KEY_F1, "F1", "this help", toggle_help},
        Action{GLFW_KEY_TAB, "Tab", "panels", toggle_panels},
        Action{GLFW_KEY_F, "F", "orbit or fly", toggle_flying},
        Action{GLFW_KEY_HOME, "Home", "back to the first view", go_home},
        Action{GLFW_KEY_L, "L", "put the light where the camera is", place_light_at_camera},
        Action{GLFW_KEY_N, "N", "select the next light", next_light},
        Action{GLFW_KEY_G, "G", "next engine", next_engine},
        Action{GLFW_KEY_P, "P", "next preset", next_preset},
        Action{GLFW_KEY_B, "B", "one more bounce", more_bounces},
        Action{GLFW_KEY_V, "V", "one bounce less", fewer_bounces},
        Action{GLFW_KEY_PAGE_UP, "Page up", "brighter", brighter},
        Action{GLFW_KEY_PAGE_DOWN, "Page down", "darker", darker},
        Action{GLFW_KEY_X, "X", "automatic exposure", automatic_exposure},
        Action{GLFW_KEY_F12, "F12", "save the picture as PNG", save_picture},
        Action{GLFW_KEY_ESCAPE, "Escape", "close", close},
    };
    return kActions;
}

std::span<const Gesture> gestures() {
    static constexpr std::array kGestures = {
        Gesture{"left drag", "turn around the point under the cursor (orbit), look around (fly)"},
        Gesture{"right or middle drag", "shift the view"},
        Gesture{"scroll", "go to the point under the cursor (orbit), speed (fly)"},
        Gesture{"W A S D, E Q", "fly; with Shift faster"},
        Gesture{"Shift + left drag", "aim the light at the point under the cursor"},
        Gesture{"Shift + right drag", "move the light sideways"},
    };
    return kGestures;
}

void run_actions(ViewModel& model, std::span<const int> keys) {
    for (const int key : keys)
        for (const Action& action : actions())
            if (action.key == key) action.run(model);
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
