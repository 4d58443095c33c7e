#include "viewer/light/edits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/registry.h"
#include "gi/scene/scene_lights.h"
#include "io/files/free_name.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostLights = 64, kMostUndone = 100;

/// Returns the strength that makes a surface of albedo .5, turned 45 degrees from the light, look mid-grey.
double fitting_strength(const gi::SceneLight& light, double ev, double metres_per_unit) {
    const double irradiance = 0.18 * std::exp2(-ev) * std::numbers::pi / (0.5 * std::numbers::sqrt2 / 2);
    const double distance = glm::distance(light.position, light.target) * metres_per_unit;
    const double intensity = irradiance * distance * distance;
    const double metres2 = metres_per_unit * metres_per_unit;
    switch (light.kind) {
        case gi::LightKind::spot:
        case gi::LightKind::point:
            return intensity;
        case gi::LightKind::directional:
            return irradiance;
        case gi::LightKind::rectangle:
            return intensity / (light.width * light.height * metres2);
        case gi::LightKind::disc:
            return intensity / (std::numbers::pi * light.radius * light.radius * metres2);
    }
    return 1;
}

}  // namespace

void remember_lights(ViewModel& model) {
    auto& undo = model.light_tools.undo;
    if (!undo.empty() && undo.back() == model.scene.lights) return;
    undo.push_back(model.scene.lights);
    if (undo.size() > kMostUndone) undo.erase(undo.begin());
}

void undo_lights(ViewModel& model) {
    auto& undo = model.light_tools.undo;
    if (undo.empty()) return;
    model.scene.lights = std::move(undo.back());
    undo.pop_back();
    model.light = std::min(model.light, model.scene.lights.size());
    model.scene_changed();
    model.message = "the lights are as they were";
}

void add_light(ViewModel& model, gi::LightKind kind) {
    static constexpr const char* kNames[] = {"spot", "point", "sun", "rectangle", "disc"};
    if (model.scene.lights.size() >= kMostLights) {
        model.message = fmt::format("a scene has at most {} lights", kMostLights);
        return;
    }
    remember_lights(model);
    gi::SceneLight light;
    light.kind = kind;
    light.name = fmt::format("{} {}", kNames[static_cast<size_t>(kind)], model.scene.lights.size() + 1);
    light.target = model.rig.pivot();
    const double size = model.scene_size / 6;
    light.position = light.target + glm::dvec3(-0.3, -0.2, 1) * size;
    if (kind == gi::LightKind::directional) {
        light.target -= light.position;
        light.position = glm::dvec3(0);
        light.angular_radius = 0.265 * std::numbers::pi / 180;  // the sun's
    }
    if (kind == gi::LightKind::rectangle) light.width = light.height = size / 4;
    if (kind == gi::LightKind::disc) light.radius = size / 8;
    const double metres = model.picture ? model.picture->metres_per_unit : 1;
    const double ev = model.scene.exposure_ev.value_or(model.picture ? model.picture->exposure_ev : 0);
    light.strength = glm::dvec3(fitting_strength(light, ev, metres));
    if (kind == gi::LightKind::point)
        light.target = light.position - glm::dvec3(0, 0, 1);  // the same default as in scene files
    model.scene.lights.push_back(light);
    model.light = model.scene.lights.size() - 1;
    model.scene_changed();
    model.message = fmt::format("added {}", light.name);
}

void duplicate_light(ViewModel& model) {
    const gi::SceneLight* light = model.selected_light();
    if (!light || model.scene.lights.size() >= kMostLights) return;
    remember_lights(model);
    gi::SceneLight copy = *light;
    copy.name += " copy";
    const glm::dvec3 step = model.rig.right() * (model.scene_size / 50);
    copy.position += step;
    copy.target += step;
    model.scene.lights.push_back(copy);
    model.light = model.scene.lights.size() - 1;
    model.scene_changed();
}

void remove_light(ViewModel& model) {
    if (!model.selected_light()) return;
    remember_lights(model);
    model.scene.lights.erase(model.scene.lights.begin() + static_cast<ptrdiff_t>(model.light));
    if (model.light > 0) --model.light;
    model.scene_changed();
    model.message = "the light is gone; Alt+Z brings it back";
}

void switch_selected_light(ViewModel& model) {
    gi::SceneLight* light = model.selected_light();
    if (!light) return;
    light->on = !light->on;
    model.scene_changed();
    model.message = fmt::format("light {} {}", model.light + 1, light->on ? "on" : "off");
}

void set_sun(ViewModel& model, const std::optional<gi::SunMoment>& sun) {
    gi::SceneLight* light = model.selected_light();
    if (!light || light->kind != gi::LightKind::directional) return;
    light->sun = sun;
    gi::follow_sun(*light);
    model.scene_changed();
}

void compare_with(ViewModel& model, const std::string& engine) {
    const auto engines = gi::engines();
    const bool known = std::ranges::any_of(engines, [&](const auto& e) { return e.info.name == engine; });
    if (!known) {
        model.scene.comparison.reset();
    } else {
        if (!model.scene.comparison) model.scene.comparison.emplace();
        model.scene.comparison->engine = engine;
    }
    model.scene_changed();
}

gi::Scene scene_to_save(const ViewModel& model) {
    gi::Scene scene = model.scene;
    std::erase_if(scene.cameras, [](const gi::SceneCamera& camera) { return camera.name == "view"; });
    gi::SceneCamera view = model.rig.camera();
    view.name = "view";
    if (const auto preset = find_preset(model.preset)) scene.render = settings_over(*preset, model.settings);
    scene.render.engine = model.engine;
    scene.render.scale.reset();
    if (model.resolution_scale != 1) scene.render.scale = model.resolution_scale;
    scene.cameras.insert(scene.cameras.begin(), view);
    return scene;
}

Result<void> save_scene_as(ViewModel& model, const std::filesystem::path& path) {
    LightTools& tools = model.light_tools;
    LUCARNE_TRY(gi::save_scene(scene_to_save(model), path, path == tools.scene_file));
    tools.scene_file = path.string();
    tools.saved.mark(model.scene, model.scene_version);
    return {};
}

std::filesystem::path scene_place(const ViewModel& model) {
    if (!model.light_tools.scene_file.empty()) return model.light_tools.scene_file;
    return free_name(model.pictures, "scene", {".json"}).string() + ".json";
}

void save_scene(ViewModel& model) {
    const auto path = scene_place(model);
    const auto saved = save_scene_as(model, path);
    model.message = saved ? "saved " + path.string() : saved.error().line();
}

}  // namespace lucarne::viewer
