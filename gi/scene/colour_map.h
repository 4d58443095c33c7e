#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

namespace lucarne::gi {

/// Colour maps in which equal steps of the value look like steps of the same kind.
enum class ColourMap : uint8_t { viridis, cividis, magma, turbo, cool_warm, grey };
/// As files and options call them, in the order of the enumerators.
std::span<const std::string_view> colour_map_names();

/// sRGB, 0 to 1, at a place from 0 to 1; what lies outside, or is no number, has the nearest end's colour.
glm::vec3 mapped_colour(ColourMap map, double place);

/// A class of the ASPRS LAS specification.
struct ClassLook {
    uint8_t number;
    std::string_view name;
    glm::vec3 colour;  ///< sRGB
};
/// All classes that LAS 1.4-R15 names, by number (table 17).
std::span<const ClassLook> named_classes();
/// "Ground"; "Reserved" for 23 to 63, "User class" beyond.
std::string_view class_name(uint8_t number);
glm::vec3 class_colour(uint8_t number);

/// Colours that are told apart, also by the colour-blind, for small numbers; they come round again.
glm::vec3 ordinal_colour(uint64_t number);

}  // namespace lucarne::gi
