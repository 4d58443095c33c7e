#pragma once

#include <array>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

// Frames that are no map: angles, and coordinates from the centre of the earth. Distances, heights or the
// direction up are wrong in them, so they are warned of, with a projected system that fits the place.
namespace lucarne::io {

using StatedBox = std::optional<std::array<glm::dvec3, 2>>;  ///< lowest and highest corner, as stated

/// Returns whether the box is in metres from the earth's centre (geocentric, "ECEF"): about as far away as
/// the earth's surface, and above or below the equator by more than any mountain is high.
bool from_earth_centre(const StatedBox& box);
/// Returns whether the box may be degrees of longitude and latitude whose last digits are as fine as those of
/// lengths: a scale of a millionth or less for x and y, and a hundred times that or more for z.
bool like_degrees(const StatedBox& box, const glm::dvec3& scale);

/// Warns that coordinates are degrees; `sure` if a coordinate system says so.
void warn_of_degrees(const std::string& file, const StatedBox& box, bool sure);
/// Warns if coordinates are from the earth's centre.
void warn_of_earth_centre(const std::string& file, const StatedBox& box);

}  // namespace lucarne::io
