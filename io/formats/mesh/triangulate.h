#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::io::mesh {

/// Polygons of more corners that are not convex are cut as a fan: ears cost the square of the corners.
inline constexpr size_t kMostEarCorners = 256;

/// Cuts a polygon into triangles of its corners' numbers, with its own sense of rotation: a fan where it is
/// convex, else by its ears (Meisters 1975, "Polygons have ears"), seen along its mean normal (Newell).
/// Polygons that cross themselves, or stand on edge, get triangles as well, which may overlap. False: too
/// many corners for ears.
bool triangulate(std::span<const glm::dvec3> polygon, std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace lucarne::io::mesh
