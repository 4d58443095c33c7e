#include "viewer/commands/options/look_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "viewer/commands/find_name.h"
#include "viewer/commands/options/numbers.h"

namespace lucarne::viewer {
namespace {

/// Parses "scene", "r,g,b" or "r,g,b:r,g,b".
Result<gi::Backdrop> parse_background(const std::string& text) {
    gi::Backdrop backdrop;
    if (text == "scene") return backdrop;
    const size_t colon = text.find(':');
    const auto colour = [](const std::string& part) -> Result<glm::dvec3> {
        LUCARNE_ASSIGN(const auto n, parse_numbers("--background", part, ',', 3));
        for (const double v : n)
            if (v < 0 || v > 1) return bad_arguments("--background", fmt::format("{} is not from 0 to 1", v));
        return glm::dvec3(n[0], n[1], n[2]);
    };
    backdrop.kind = gi::Backdrop::Kind::colour;
    LUCARNE_ASSIGN(backdrop.top, colour(text.substr(0, colon)));
    if (colon == std::string::npos) return backdrop;
    backdrop.kind = gi::Backdrop::Kind::gradient;
    LUCARNE_ASSIGN(backdrop.bottom, colour(text.substr(colon + 1)));
    return backdrop;
}

Result<void> apply_colours(const LookOptions& options, gi::Look& look) {
    if (options.colour.starts_with("attribute:")) {
        look.colour = gi::ColourBy::attribute;
        look.attribute = options.colour.substr(std::string_view("attribute:").size());
    } else if (!options.colour.empty()) {
        LUCARNE_ASSIGN(const size_t by, find_name("--colour", options.colour, gi::colour_names()));
        look.colour = static_cast<gi::ColourBy>(by);
        if (look.colour == gi::ColourBy::attribute)
            return bad_arguments("--colour", "no attribute is named", "give attribute:NAME");
    }
    if (!options.map.empty()) {
        LUCARNE_ASSIGN(const size_t map, find_name("--colour-map", options.map, gi::colour_map_names()));
        look.map = static_cast<gi::ColourMap>(map);
    }
    look.reversed |= options.reversed;
    if (!options.range.empty()) {
        LUCARNE_ASSIGN(const auto n, parse_numbers("--range", options.range, ':', 2));
        look.range = gi::ValueRange{n[0], n[1]};
    }
    for (const int number : options.hidden_classes) look.hidden_classes.set(static_cast<size_t>(number));
    return {};
}

}  // namespace

void add_look_options(Arguments& command, LookOptions& options) {
    const auto names = [](std::span<const std::string_view> all) {
        return fmt::format("{}", fmt::join(all, ", "));
    };
    command
        .add("--colour,--color", options.colour,
             "What the points' colours show: " + names(gi::colour_names()) +
                 "; name an attribute as attribute:NAME")
        .type_name("WHAT");
    command.add("--colour-map,--color-map", options.map, names(gi::colour_map_names())).type_name("NAME");
    command.flag("--reverse-map", options.reversed, "Reverse the colour map");
    command
        .add("--range", options.range, "Values at the colour map's ends; by default the range of most points")
        .type_name("LOW:HIGH");
    command.add("--shading", options.shading, "Shading of the engine unlit: " + names(gi::shading_names()))
        .type_name("NAME");
    command.add("--shading-strength", options.shading_strength, "Strength of the shading; 0: none, 1: usual")
        .range(0.0, 10.0)
        .type_name("X");
    command.add("--point-size", options.point_size, "Scale of the points' size")
        .range(0.05, 20.0)
        .type_name("X");
    command.add("--point-pixels", options.point_pixels, "Draw all points with this size, in pixels")
        .range(0.0, 64.0)
        .type_name("N");
    command
        .add("--outliers", options.outliers,
             "How strictly to leave out points that lie on no surface; 0: draw all points, 1: leave out what "
             "the converter found, 2: also discs that are far larger than their neighbours, 3: more of them")
        .range(0, 3)
        .type_name("N");
    command.flag("--single-discs", options.single_discs,
                 "Show in each pixel the nearest point's disc alone, not blended with those around it");
    command.flag("--front-only", options.front_only,
                 "Do not draw points that face away from the camera: look into rooms from outside");
    command.flag("--open-holes", options.open_holes,
                 "Leave holes of the scan open that the conversion has filled");
    command
        .add("--background", options.background,
             "Background: scene, one colour, or a gradient from top to bottom (sRGB, 0 to 1)")
        .type_name("R,G,B[:R,G,B]");
    command.add("--hide-class", options.hidden_classes, "Hide these classes")
        .range(0, 255)
        .separator(',')
        .type_name("N,...");
    add_clip_options(command, options.clip);
    command.flag("--clip-casts", options.clip_casts,
                 "Clipped points are invisible, but still block and bounce light");
    command.flag("--legend", options.legend, "Draw a legend of the colours over the picture (.png)");
    command.flag("--axes", options.axes, "Draw the directions of x, y and z over the picture (.png)");
    command.flag("--scale-bar", options.scale_bar,
                 "Draw a scale bar for the distance of the camera's target over the picture (.png)");
}

Result<void> apply(const LookOptions& options, gi::Look& look) {
    LUCARNE_TRY(apply_colours(options, look));
    LUCARNE_TRY(apply(options.clip, look.clip));
    look.clip.casts |= options.clip_casts;
    if (!options.shading.empty()) {
        LUCARNE_ASSIGN(const size_t shading, find_name("--shading", options.shading, gi::shading_names()));
        look.unlit.shading = static_cast<gi::Shading>(shading);
    }
    look.outliers = options.outliers.value_or(look.outliers);
    look.single_discs |= options.single_discs;
    look.front_only |= options.front_only;
    look.open_holes |= options.open_holes;
    look.legend |= options.legend;
    look.axes |= options.axes;
    look.scale_bar |= options.scale_bar;
    look.unlit.strength = options.shading_strength.value_or(look.unlit.strength);
    look.point_size = options.point_size.value_or(look.point_size);
    look.point_pixels = options.point_pixels.value_or(look.point_pixels);
    if (!options.background.empty()) {
        LUCARNE_ASSIGN(look.backdrop, parse_background(options.background));
    }
    return {};
}

}  // namespace lucarne::viewer
