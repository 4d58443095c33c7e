#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/clip.h"
#include "gi/scene/colour_map.h"

namespace lucarne::gi {

/// What a point's colour says. Engines take it for the albedo, so that every engine lights it.
enum class ColourBy : uint8_t {
    colour,
    intensity,
    elevation,
    classification,
    return_number,
    scan,
    normal,
    attribute
};
/// As files and options call them, in the order of the enumerators.
std::span<const std::string_view> colour_names();
/// Whether a range of values is mapped to a colour map; the others have colours of their own.
bool has_range(ColourBy by);

/// How the engine `unlit` shades.
enum class Shading : uint8_t { flat, eye_dome, occlusion };
std::span<const std::string_view> shading_names();

struct Unlit {
    Shading shading = Shading::eye_dome;
    double strength = 1;           ///< of the shading, 0 to 10
    double eye_dome_pixels = 1.5;  ///< to the neighbours, of a picture 1080 high
    double occlusion_reach = 4;    ///< how far others darken, in percent of the distance to the eye
    bool operator==(const Unlit&) const = default;
};

struct ValueRange {
    double low = 0, high = 1;
    bool operator==(const ValueRange&) const = default;
};

/// Behind the points. sRGB, 0 to 1: what the screen shows, whatever engine, exposure or tone curve.
struct Backdrop {
    enum class Kind : uint8_t { scene, colour, gradient } kind = Kind::scene;
    glm::dvec3 top{0.2, 0.24, 0.3};  ///< or all of it
    glm::dvec3 bottom{0.03, 0.035, 0.045};
    bool operator==(const Backdrop&) const = default;
};

/// How points are shown, whatever lights them.
struct Look {
    ColourBy colour = ColourBy::colour;
    std::string attribute;  ///< by ColourBy::attribute: its name, with ".1" and so on for further components
    ColourMap map = ColourMap::viridis;
    bool reversed = false;            ///< the colour map
    std::optional<ValueRange> range;  ///< of the values; elevations in world units. Empty: measured
    std::bitset<256> hidden_classes;  ///< neither seen nor in the light's way
    double point_size = 1;            ///< of the surfels' radii as the eye sees them, .05 to 20
    double point_pixels = 0;          ///< over 0: the diameter of every point, pixels
    Unlit unlit;
    Backdrop backdrop;
    Clip clip;
    bool legend = false, axes = false, scale_bar = false;  ///< over the picture

    bool operator==(const Look&) const = default;
};

/// Whether points must be coloured anew.
bool same_colours(const Look& a, const Look& b);

}  // namespace lucarne::gi
