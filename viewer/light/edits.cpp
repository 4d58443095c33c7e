#include "viewer/light/edits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/scene/scene_lights.h"
#include "gi/scene/scene_limits.h"
#include "gi/scene/sky_model.h"

namespace lucarne::viewer {
namespace {

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

void add_light(const Lighting& model, gi::LightKind kind) {
    static constexpr const char* kNames[] = {"spot", "point", "sun", "rectangle", "disc"};
    if (model.view.scene.lights.size() >= gi::kMostLights) {
        model.view.message = fmt::format("a scene has at most {} lights", gi::kMostLights);
        return;
    }
    model.lights.mood.reset();
    gi::SceneLight light;
    light.kind = kind;
    light.name = fmt::format("{} {}", kNames[static_cast<size_t>(kind)], model.view.scene.lights.size() + 1);
    light.target = model.view.rig.pivot();
    const double size = model.view.scene_size / 6;
    light.position = light.target + glm::dvec3(-0.3, -0.2, 1) * size;
    if (kind == gi::LightKind::directional) {
        light.target -= light.position;
        light.position = glm::dvec3(0);
        light.angular_radius = gi::kSunRadius;
    }
    if (kind == gi::LightKind::rectangle) light.width = light.height = size / 4;
    if (kind == gi::LightKind::disc) light.radius = size / 8;
    const double metres = model.view.picture ? model.view.picture->metres_per_unit : 1;
    const double ev =
        model.view.scene.exposure_ev.value_or(model.view.picture ? model.view.picture->exposure_ev : 0);
    light.strength = glm::dvec3(fitting_strength(light, ev, metres));
    if (kind == gi::LightKind::point)
        light.target = light.position - glm::dvec3(0, 0, 1);  // the same default as in scene files
    model.view.scene.lights.push_back(light);
    model.lights.selected = model.view.scene.lights.size() - 1;
    model.view.scene_changed();
    model.view.message = fmt::format("added {}", light.name);
}

void duplicate_light(const Lighting& model) {
    const gi::SceneLight* light = model.selected_light();
    if (!light || model.view.scene.lights.size() >= gi::kMostLights) return;
    model.lights.mood.reset();
    gi::SceneLight copy = *light;
    copy.name += " copy";
    const glm::dvec3 step = model.view.rig.right() * (model.view.scene_size / 50);
    copy.position += step;
    copy.target += step;
    model.view.scene.lights.push_back(copy);
    model.lights.selected = model.view.scene.lights.size() - 1;
    model.view.scene_changed();
}

void remove_light(const Lighting& model) {
    if (!model.selected_light()) return;
    model.lights.mood.reset();
    model.view.scene.lights.erase(model.view.scene.lights.begin() +
                                  static_cast<ptrdiff_t>(model.lights.selected));
    if (model.lights.selected > 0) --model.lights.selected;
    model.view.scene_changed();
    model.view.message = "the light is gone; Ctrl+Z brings it back";
}

void switch_selected_light(const Lighting& model) {
    gi::SceneLight* light = model.selected_light();
    if (!light) return;
    light->on = !light->on;
    model.view.scene_changed();
    model.view.message = fmt::format("light {} {}", model.lights.selected + 1, light->on ? "on" : "off");
}

void set_sun(const Lighting& model, const std::optional<gi::SunMoment>& sun) {
    gi::SceneLight* light = model.selected_light();
    if (!light || light->kind != gi::LightKind::directional) return;
    light->sun = sun;
    gi::follow_sun(*light);
    model.view.scene_changed();
}

void set_clear_sky(const Lighting& model, const gi::SkySettings& sky) {
    gi::Scene& scene = model.view.scene;
    const bool had_one = scene.environment && scene.environment->sky;
    const auto sun = std::ranges::find(scene.lights, gi::LightKind::directional, &gi::SceneLight::kind);
    // So that sun and sky agree; the user may give the sun another strength later.
    if (!had_one && sun != scene.lights.end()) sun->daylight = true;
    auto made = std::make_shared<gi::Environment>();
    made->sky = sky;
    scene.environment = std::move(made);
    scene.environment_on |= !had_one;
    model.view.scene_changed();
}

}  // namespace lucarne::viewer
