#include "viewer/light/session.h"

#include <utility>

#include <imgui.h>

#include "viewer/light/day.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {

void LightSession::follow_sky(const Lighting& model) {
    LightModel& tools = model.lights;
    for (const auto& command : tools.commands.take()) {
        tools.sky_problem.clear();
        skies_.load(std::get<LoadSky>(command).file);
    }
    if (auto sky = skies_.take()) {
        if (*sky) {
            model.view.scene.environment = std::move(**sky);
            model.view.scene.environment_on = true;
            model.view.scene_changed();
        } else {
            model.view.message = tools.sky_problem = sky->error().line();
        }
    }
    tools.reading_sky = skies_.reading();
}

bool LightSession::follow_day(const Lighting& model, double seconds) {
    advance_day(model, seconds);
    return model.lights.plays_day;
}

void LightSession::take_gesture(const Lighting& model) {
    const glm::dvec2 move = cursor_move();
    if (move == glm::dvec2(0.0)) return;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left) && model.view.picture) {
        if (const auto point = model.view.picture->pick(cursor())) aim_light(model, *point);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
        shift_light(model, {move.x, -move.y});
    }
}

}  // namespace lucarne::viewer
