#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

namespace lucarne::io {

/// The materials of surfaces. Each has an albedo that varies over space by a rule.
enum class Finish : uint8_t {
    white,
    red,
    green,         ///< red and green: the walls of the Cornell box
    half,          ///< .5 everywhere
    ashlar,        ///< stone blocks in courses
    rubbed_stone,  ///< stone without joints: columns, ribs, mouldings
    plaster,
    tiles,   ///< a floor of square tiles in two colours, laid diagonally
    slabs,   ///< a floor of large pale slabs
    boards,  ///< wooden floor boards
    wood,
    carpet,
    red_cloth,
    blue_cloth,
    gold_cloth,
    linen,
    ochre,
    teal,  ///< painted walls
    gilt,
    marble,
};

/// Returns the linear Rec. 709 albedo at a position (metres) of a surface with this normal; each channel is
/// in (0, .95).
glm::dvec3 albedo_at(Finish finish, const glm::dvec3& position, const glm::dvec3& normal);

/// Returns whether the albedo of such a surface differs from place to place.
bool albedo_varies(Finish finish);

/// Converts linear [0, 1] to an 8-bit sRGB code (IEC 61966-2-1).
uint8_t srgb_code(double linear);

}  // namespace lucarne::io
