#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "octree/normals/surface/chunk_surface.h"

namespace lucarne::octree {

/// Gives sites at the rim of a board's face the plane of the board's end where their station is behind the
/// face and sees the end. A point there lies in both planes as far as noise tells, and the face, which has
/// more points, was taken. `ray_of_site`: to the stations; zero where they are unknown.
void take_seen_ends(ChunkSurface& surface, std::span<const glm::dvec3> ray_of_site);

}  // namespace lucarne::octree
