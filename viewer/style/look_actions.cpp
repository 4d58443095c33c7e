#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "viewer/overlay/overlay.h"
#include "viewer/style/look_edits.h"
#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

/// Selects the next colouring. Skips attributes, which need a name and are chosen in the panel.
void next_colour(ViewModel& model) {
    gi::Look& look = model.scene.look;
    const auto next = (static_cast<size_t>(look.colour) + 1) % static_cast<size_t>(gi::ColourBy::attribute);
    look.colour = static_cast<gi::ColourBy>(next);
    look.range.reset();
    model.scene_changed();
    model.message = "colour: " + legend_title(look);
}
void own_colours(ViewModel& model) {
    model.scene.look.colour = gi::ColourBy::colour;
    model.scene_changed();
}
void next_colour_map(ViewModel& model) {
    gi::Look& look = model.scene.look;
    look.map =
        static_cast<gi::ColourMap>((static_cast<size_t>(look.map) + 1) % gi::colour_map_names().size());
    model.scene_changed();
    model.message = fmt::format("colour map {}", gi::colour_map_names()[static_cast<size_t>(look.map)]);
}

bool is_unlit(const ViewModel& model) {
    return !is_lit(model);
}
void next_shading(ViewModel& model) {
    gi::Unlit& unlit = model.scene.look.unlit;
    unlit.shading =
        static_cast<gi::Shading>((static_cast<size_t>(unlit.shading) + 1) % gi::shading_names().size());
    model.scene_changed();
    model.message = fmt::format("shading {}", gi::shading_names()[static_cast<size_t>(unlit.shading)]);
}

void scale_points(ViewModel& model, double factor) {
    gi::Look& look = model.scene.look;
    if (look.point_pixels > 0)
        look.point_pixels = std::clamp(look.point_pixels * factor, 1.0, 64.0);
    else
        look.point_size = std::clamp(look.point_size * factor, 0.05, 20.0);
    model.scene_changed();
}
void larger_points(ViewModel& model) {
    scale_points(model, 1.25);
}
void smaller_points(ViewModel& model) {
    scale_points(model, 0.8);
}

void toggle_legend(ViewModel& model) {
    model.scene.look.legend = !model.scene.look.legend;
}
bool shows_legend(const ViewModel& model) {
    return model.scene.look.legend;
}
void toggle_axes(ViewModel& model) {
    model.scene.look.axes = !model.scene.look.axes;
}
bool shows_axes(const ViewModel& model) {
    return model.scene.look.axes;
}
void toggle_scale_bar(ViewModel& model) {
    model.scene.look.scale_bar = !model.scene.look.scale_bar;
}
bool shows_scale_bar(const ViewModel& model) {
    return model.scene.look.scale_bar;
}

bool is_clipped(const ViewModel& model) {
    return model.scene.look.clip.active();
}
void clear_clip(ViewModel& model) {
    model.scene.look.clip = {};
    model.scene_changed();
}

}  // namespace

std::span<const Action> look_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_C}, "Look", "Colour by the next attribute", next_colour},
        Action{{GLFW_KEY_C, GLFW_MOD_SHIFT}, "Look", "The points' own colours", own_colours},
        Action{{GLFW_KEY_C, GLFW_MOD_ALT}, "Look", "Next colour map", next_colour_map},
        Action{{GLFW_KEY_U}, "Look", "Light", switch_light, nullptr, is_lit},
        Action{{GLFW_KEY_U, GLFW_MOD_SHIFT}, "Look", "Next shading without light", next_shading, is_unlit},
        Action{{GLFW_KEY_PERIOD}, "Look", "Larger points", larger_points},
        Action{{GLFW_KEY_COMMA}, "Look", "Smaller points", smaller_points},
        Action{{GLFW_KEY_K}, "Look", "Legend", toggle_legend, nullptr, shows_legend},
        Action{{GLFW_KEY_K, GLFW_MOD_SHIFT}, "Look", "Axes", toggle_axes, nullptr, shows_axes},
        Action{{GLFW_KEY_K, GLFW_MOD_ALT}, "Look", "Scale bar", toggle_scale_bar, nullptr, shows_scale_bar},
        Action{{GLFW_KEY_I}, "Look/Clip", "Add a box", add_clip_box},
        Action{{GLFW_KEY_I, GLFW_MOD_SHIFT}, "Look/Clip", "Add a plane", add_clip_plane},
        Action{{GLFW_KEY_I, GLFW_MOD_ALT}, "Look/Clip", "Clip nothing", clear_clip, is_clipped},
    };
    return kActions;
}

}  // namespace lucarne::viewer
