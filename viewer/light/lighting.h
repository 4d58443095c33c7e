#pragma once

#include <span>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "viewer/light/model.h"
#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// What the actions and panels of lights act on.
struct Lighting {
    View& view;
    LightModel& lights;

    gi::SceneLight* selected_light() const {
        auto& all = view.scene.lights;
        return lights.selected < all.size() ? &all[lights.selected] : nullptr;
    }
};

std::span<const Action<const Lighting>> light_actions();

void draw_light_panel(const Lighting& model);  ///< lamps, suns, sky, emitting classes
void draw_sun(const Lighting& model);          ///< part of the light panel: direction of the selected sun
void draw_sky(const Lighting& model);
void draw_emitters(const Lighting& model);
/// Lights the open scans in a mood, with the engine that shows it.
void take_mood(const Lighting& model, Mood mood);
/// Whether the scan shows rooms where the camera is: also in a house that was entered.
bool shows_rooms(const View& view);
/// Returns the engine that shows a mood where the camera is: in a house that was entered that of rooms.
std::string_view engine_here(const View& view, Mood mood);
/// Makes the light of the mood anew for where the camera is now: lamps in a house that was entered, which the
/// sun outside would leave dark. Does nothing once the user has changed a light.
void light_for_place(const Lighting& model);
void draw_mood_bar(const Lighting& model);  ///< the moods as buttons over the picture, if there is room
/// Draws lights' handles over the picture while the section Light is open, and lets the mouse drag them.
/// Returns true while one is dragged.
bool take_light_handles(const Lighting& model);

// Actions on the selected light. Positions are in world units.
void place_light_at_camera(const Lighting& model);
void aim_light(const Lighting& model, const glm::dvec3& target);
/// Moves the light and its target parallel to the picture. `shift` is in shares of the picture's height, to
/// the right and up.
void shift_light(const Lighting& model, const glm::dvec2& shift);

}  // namespace lucarne::viewer
