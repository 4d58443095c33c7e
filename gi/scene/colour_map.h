#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

namespace lucarne::gi {

/// Colour maps in which equal steps of the value look like equal steps.
enum class ColourMap : uint8_t { viridis, cividis, magma, turbo, cool_warm, grey };
/// Their names in files and options, in the order of the enumerators.
std::span<const std::string_view> colour_map_names();

/// Returns the sRGB colour (0 to 1) at a place from 0 to 1. Places outside are clamped; NaN counts as 0.
glm::vec3 mapped_colour(ColourMap map, double place);

/// A class of the ASPRS LAS specification.
struct ClassLook {
    uint8_t number;
    std::string_view name;
    glm::vec3 colour;  ///< sRGB
};
/// Returns all classes that LAS 1.4-R15 names, by number (table 17).
std::span<const ClassLook> named_classes();
/// Returns "Ground" and so on, "Reserved" for 23 to 63, "User class" beyond.
std::string_view class_name(uint8_t number);
glm::vec3 class_colour(uint8_t number);

/// Returns colours for small numbers that can be told apart, also by the colour-blind. They repeat for
/// larger numbers.
glm::vec3 ordinal_colour(uint64_t number);

}  // namespace lucarne::gi
