#include <algorithm>
#include <array>
#include <cmath>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/registry.h"
#include "viewer/light/day.h"
#include "viewer/light/edits.h"
#include "viewer/light/lighting.h"
#include "viewer/light/preparing.h"
#include "viewer/opening/moods.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Lighting>;

void next_light(const Lighting& model) {
    if (model.view.scene.lights.empty()) return;
    model.lights.selected = (model.lights.selected + 1) % model.view.scene.lights.size();
    model.view.message = fmt::format("light {} selected", model.lights.selected + 1);
}

bool has_light(const Lighting& model) {
    return !model.view.scene.lights.empty();
}

template <gi::LightKind Kind>
void add(const Lighting& model) {
    add_light(model, Kind);
}
template <Mood Of>
void light_as(const Lighting& model) {
    take_mood(model, Of);
}
bool has_site(const Lighting& model) {
    return !model.view.site.outline.empty();
}
bool is_on(const Lighting& model) {
    return has_light(model) && model.lights.selected < model.view.scene.lights.size() &&
           model.view.scene.lights[model.lights.selected].on;
}
bool can_prepare(const Lighting& model) {
    return why_not_prepared(model).empty();
}
void toggle_handles(const Lighting& model) {
    model.lights.show_handles = !model.lights.show_handles;
}
bool has_sun(const Lighting& model) {
    return moment_of_sun(model.view.scene).has_value();
}
bool plays_day(const Lighting& model) {
    return model.lights.plays_day;
}
bool shows_handles(const Lighting& model) {
    return model.lights.show_handles;
}

/// What the scan shows, seen from where the camera is: a house that was entered is one of rooms.
Site site_about(const View& view) {
    Site site = view.site;
    if (site.inside && view.entered) site.kind = SiteKind::interior;
    return site;
}

/// Replaces the light by a mood's. The sun stays at the hour that the user has chosen.
void set_mood_here(View& view, Mood mood) {
    std::optional<gi::SunMoment> chosen;
    for (const gi::SceneLight& light : view.scene.lights)
        if (light.sun) chosen = light.sun;
    set_mood(view.scene, mood, site_about(view), view.rig.camera());
    if (chosen && mood == Mood::daylight) set_daytime(view.scene, *chosen);
    view.scene_changed();
}

}  // namespace

std::span<const Action<const Lighting>> light_actions() {
    using Kind = gi::LightKind;
    static constexpr int kAltShift = GLFW_MOD_ALT | GLFW_MOD_SHIFT;
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_L}, "Light", "Put the light where the camera is", place_light_at_camera, has_light},
        Entry{{GLFW_KEY_N}, "Light", "Select the next light", next_light, has_light},
        Entry{{GLFW_KEY_O, GLFW_MOD_ALT}, "Light", "On", switch_selected_light, has_light, is_on},
        Entry{{GLFW_KEY_1, kAltShift}, "Light/Add", "Spot", add<Kind::spot>},
        Entry{{GLFW_KEY_2, kAltShift}, "Light/Add", "Point", add<Kind::point>},
        Entry{{GLFW_KEY_3, kAltShift}, "Light/Add", "Sun", add<Kind::directional>},
        Entry{{GLFW_KEY_4, kAltShift}, "Light/Add", "Rectangle", add<Kind::rectangle>},
        Entry{{GLFW_KEY_5, kAltShift}, "Light/Add", "Disc", add<Kind::disc>},
        Entry{{GLFW_KEY_1, GLFW_MOD_SHIFT},
              "Light/Mood",
              "Scan colours",
              light_as<Mood::scan_colours>,
              has_site},
        Entry{{GLFW_KEY_2, GLFW_MOD_SHIFT}, "Light/Mood", "Daylight", light_as<Mood::daylight>, has_site},
        Entry{{GLFW_KEY_3, GLFW_MOD_SHIFT}, "Light/Mood", "Evening", light_as<Mood::evening>, has_site},
        Entry{{GLFW_KEY_4, GLFW_MOD_SHIFT},
              "Light/Mood",
              "Raking light",
              light_as<Mood::raking_light>,
              has_site},
        Entry{{GLFW_KEY_5, GLFW_MOD_SHIFT}, "Light/Mood", "Museum", light_as<Mood::museum>, has_site},
        Entry{{GLFW_KEY_6, GLFW_MOD_SHIFT}, "Light/Mood", "Clay", light_as<Mood::clay>, has_site},
        Entry{{GLFW_KEY_D, GLFW_MOD_ALT}, "Light", "Duplicate", duplicate_light, has_light},
        Entry{{GLFW_KEY_DELETE, GLFW_MOD_ALT}, "Light", "Delete", remove_light, has_light},
        Entry{{GLFW_KEY_R, GLFW_MOD_ALT}, "Light", "Prepare light in advance", prepare, can_prepare},
        Entry{{GLFW_KEY_R, kAltShift}, "Light", "Stop preparing", stop_preparing, is_preparing},
        Entry{{GLFW_KEY_SPACE, kAltShift}, "Light", "Play the day", play_day, has_sun, plays_day},
        Entry{{GLFW_KEY_H, GLFW_MOD_ALT}, "Light", "Handles", toggle_handles, nullptr, shows_handles},
    };
    return kActions;
}

bool shows_rooms(const View& view) {
    return site_about(view).kind == SiteKind::interior;
}

std::string_view engine_here(const View& view, Mood mood) {
    return engine_of(mood, site_about(view).kind, view.is_prepared);
}

void light_for_place(const Lighting& model) {
    if (!model.lights.mood) return;
    const bool colours = *model.lights.mood == Mood::scan_colours;
    const gi::Backdrop backdrop = model.view.scene.look.backdrop;
    set_mood_here(model.view, colours ? usual_mood(site_about(model.view)) : *model.lights.mood);
    if (colours) {
        model.view.scene.look.backdrop = backdrop;
        return;
    }
    std::string& engine = model.view.method.engine;
    if (shows_moods(engine, site_about(model.view).kind, model.view.is_prepared) &&
        !gi::engine_is(engine, &gi::EngineInfo::unlit))
        engine = engine_here(model.view, *model.lights.mood);
}

void take_mood(const Lighting& model, Mood mood) {
    set_mood_here(model.view, mood);
    if (mood == Mood::scan_colours ||
        shows_moods(model.view.method.engine, site_about(model.view).kind, model.view.is_prepared))
        model.view.method.engine = engine_here(model.view, mood);
    model.lights.selected = 0;
    model.lights.mood = mood;
    model.view.light_replaced();
}

void place_light_at_camera(const Lighting& model) {
    gi::SceneLight* light = model.selected_light();
    if (!light) {
        model.view.message = "The scene has no light";
        return;
    }
    const gi::SceneCamera camera = model.view.rig.camera();
    light->position = camera.position;
    light->target = camera.target;
    model.view.scene_changed();
    model.view.message = "Light moved to the camera";
}

void aim_light(const Lighting& model, const glm::dvec3& target) {
    gi::SceneLight* light = model.selected_light();
    if (!light || glm::distance(light->position, target) < 1e-6 * model.view.scene_size) return;
    light->target = target;
    model.view.scene_changed();
}

void shift_light(const Lighting& model, const glm::dvec2& shift) {
    gi::SceneLight* light = model.selected_light();
    if (!light) return;
    const gi::SceneCamera camera = model.view.rig.camera();
    const double depth =
        std::max(std::abs(glm::dot(light->position - camera.position, model.view.rig.forward())),
                 model.view.scene_size / 100);  // so that a light at the camera moves
    const double height = 2 * std::tan(camera.vertical_fov / 2) * depth;
    const glm::dvec3 step = (model.view.rig.right() * shift.x + model.view.rig.up() * shift.y) * height;
    light->position += step;
    light->target += step;
    model.view.scene_changed();
}

}  // namespace lucarne::viewer
