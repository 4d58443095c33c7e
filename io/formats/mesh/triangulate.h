#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::io::mesh {

/// Polygons with more corners are cut as a fan even if they are not convex: the cost of ear clipping grows
/// with the square of the corners.
inline constexpr size_t kMostEarCorners = 256;

/// Cuts a polygon into triangles of corner indices, with the polygon's orientation. A convex polygon becomes
/// a fan; others are cut by their ears (Meisters 1975, "Polygons have ears"), projected along their mean
/// normal (Newell). Polygons that cross themselves, or are seen edge-on, become triangles as well, which may
/// overlap. Returns false if there are too many corners for ears.
bool triangulate(std::span<const glm::dvec3> polygon, std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace lucarne::io::mesh
