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

/// What a point's colour shows. Engines use this colour as the albedo, so every engine lights it. `clay` is
/// one light grey for all points, which shows shape alone.
enum class ColourBy : uint8_t {
    colour,
    intensity,
    elevation,
    classification,
    return_number,
    scan,
    normal,
    attribute,
    clay
};
/// Their names in files and options, in the order of the enumerators.
std::span<const std::string_view> colour_names();
/// Returns whether a range of values is mapped to a colour map. The other kinds have colours of their own.
bool has_range(ColourBy by);

/// How the engine `unlit` shades. `relief` is occlusion and a soft light beside the eye, for scans whose
/// colours show no shape.
enum class Shading : uint8_t { flat, eye_dome, occlusion, relief };
std::span<const std::string_view> shading_names();

struct Unlit {
    Shading shading = Shading::eye_dome;
    double strength = 1;           ///< of the shading, 0 to 10
    double brightness = 1;         ///< the points' own colours are shown so many times as bright
    double eye_dome_pixels = 1.5;  ///< distance to the neighbours, in a picture 1080 pixels high
    double occlusion_reach = 4;    ///< how far points darken others, in percent of the distance to the eye
    bool operator==(const Unlit&) const = default;
};

struct ValueRange {
    double low = 0, high = 1;
    bool operator==(const ValueRange&) const = default;
};

/// What is drawn behind the points. sRGB, 0 to 1: exactly what the screen shows, whatever the engine,
/// exposure or tone curve.
struct Backdrop {
    enum class Kind : uint8_t { scene, colour, gradient } kind = Kind::scene;
    glm::dvec3 top{0.2, 0.24, 0.3};  ///< upper colour of a gradient, or the single colour
    glm::dvec3 bottom{0.03, 0.035, 0.045};
    bool operator==(const Backdrop&) const = default;
};

/// How points are shown, whichever engine lights them.
struct Look {
    ColourBy colour = ColourBy::colour;
    std::string attribute;  ///< for ColourBy::attribute: its name, with ".1" and so on for further components
    ColourMap map = ColourMap::viridis;
    bool reversed = false;            ///< reverses the colour map
    std::optional<ValueRange> range;  ///< of the values, elevations in world units; empty: measured
    std::bitset<256> hidden_classes;  ///< neither drawn nor blocking light
    double point_size = 1;            ///< scales the surfels' radii for the camera only, .05 to 20
    double point_pixels = 0;          ///< if over 0: the diameter of every point, pixels
    uint32_t outliers = 1;      ///< how strictly points are left out that are on no surface, 0 (none) to 3
    bool single_discs = false;  ///< draws each pixel as its nearest disc, not blended with those around it
    bool front_only = false;    ///< leaves out points that face away from the camera
    bool open_holes = false;    ///< leaves out the surfels that fill holes of the scans
    Unlit unlit;
    Backdrop backdrop;
    Clip clip;
    bool legend = false, axes = false, scale_bar = false;  ///< drawn over the picture

    bool operator==(const Look&) const = default;
};

/// Returns whether both looks show the same points in the same colours; otherwise points have to be packed
/// again.
bool same_colours(const Look& a, const Look& b);

}  // namespace lucarne::gi
