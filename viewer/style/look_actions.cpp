#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "viewer/overlay/overlay.h"
#include "viewer/style/look_edits.h"
#include "viewer/style/styling.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Styling>;

/// Selects the next colouring. Skips attributes, which need a name and are chosen in the panel.
void next_colour(const Styling& model) {
    gi::Look& look = model.view.scene.look;
    do {
        const size_t next = (static_cast<size_t>(look.colour) + 1) % gi::colour_names().size();
        look.colour = static_cast<gi::ColourBy>(next);
    } while (look.colour == gi::ColourBy::attribute);
    look.range.reset();
    model.view.scene_changed();
    model.view.message = "colour: " + legend_title(look);
}
void own_colours(const Styling& model) {
    model.view.scene.look.colour = gi::ColourBy::colour;
    model.view.scene_changed();
}
void next_colour_map(const Styling& model) {
    gi::Look& look = model.view.scene.look;
    look.map =
        static_cast<gi::ColourMap>((static_cast<size_t>(look.map) + 1) % gi::colour_map_names().size());
    model.view.scene_changed();
    model.view.message = fmt::format("colour map {}", gi::colour_map_names()[static_cast<size_t>(look.map)]);
}

bool is_unlit(const Styling& model) {
    return !is_lit(model);
}
void next_shading(const Styling& model) {
    gi::Unlit& unlit = model.view.scene.look.unlit;
    unlit.shading =
        static_cast<gi::Shading>((static_cast<size_t>(unlit.shading) + 1) % gi::shading_names().size());
    model.view.scene_changed();
    model.view.message = fmt::format("shading {}", gi::shading_names()[static_cast<size_t>(unlit.shading)]);
}

void scale_points(const Styling& model, double factor) {
    gi::Look& look = model.view.scene.look;
    if (look.point_pixels > 0)
        look.point_pixels = std::clamp(look.point_pixels * factor, 1.0, 64.0);
    else
        look.point_size = std::clamp(look.point_size * factor, 0.05, 20.0);
    model.view.scene_changed();
}
void larger_points(const Styling& model) {
    scale_points(model, 1.25);
}
void smaller_points(const Styling& model) {
    scale_points(model, 0.8);
}

void toggle_legend(const Styling& model) {
    model.view.scene.look.legend = !model.view.scene.look.legend;
}
bool shows_legend(const Styling& model) {
    return model.view.scene.look.legend;
}
void toggle_axes(const Styling& model) {
    model.view.scene.look.axes = !model.view.scene.look.axes;
}
bool shows_axes(const Styling& model) {
    return model.view.scene.look.axes;
}
void toggle_scale_bar(const Styling& model) {
    model.view.scene.look.scale_bar = !model.view.scene.look.scale_bar;
}
bool shows_scale_bar(const Styling& model) {
    return model.view.scene.look.scale_bar;
}

bool is_clipped(const Styling& model) {
    return model.view.scene.look.clip.active();
}
void clear_clip(const Styling& model) {
    model.view.scene.look.clip = {};
    model.view.scene_changed();
}

}  // namespace

std::span<const Action<const Styling>> look_actions() {
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_C}, "Appearance", "Colour by the next attribute", next_colour},
        Entry{{GLFW_KEY_C, GLFW_MOD_SHIFT}, "Appearance", "The points' own colours", own_colours},
        Entry{{GLFW_KEY_C, GLFW_MOD_ALT}, "Appearance", "Next colour map", next_colour_map},
        Entry{{GLFW_KEY_U}, "Appearance", "Lighting", switch_light, nullptr, is_lit},
        Entry{
            {GLFW_KEY_U, GLFW_MOD_SHIFT}, "Appearance", "Next shading without light", next_shading, is_unlit},
        Entry{{GLFW_KEY_PERIOD}, "Appearance", "Larger points", larger_points},
        Entry{{GLFW_KEY_COMMA}, "Appearance", "Smaller points", smaller_points},
        Entry{{GLFW_KEY_K}, "Appearance", "Legend", toggle_legend, nullptr, shows_legend},
        Entry{{GLFW_KEY_K, GLFW_MOD_SHIFT}, "Appearance", "Axes", toggle_axes, nullptr, shows_axes},
        Entry{{GLFW_KEY_K, GLFW_MOD_ALT},
              "Appearance",
              "Scale bar",
              toggle_scale_bar,
              nullptr,
              shows_scale_bar},
        Entry{{GLFW_KEY_I}, "Appearance/Clip", "Add a box", add_clip_box},
        Entry{{GLFW_KEY_I, GLFW_MOD_SHIFT}, "Appearance/Clip", "Add a plane", add_clip_plane},
        Entry{{GLFW_KEY_I, GLFW_MOD_ALT}, "Appearance/Clip", "Clip nothing", clear_clip, is_clipped},
    };
    return kActions;
}

}  // namespace lucarne::viewer
