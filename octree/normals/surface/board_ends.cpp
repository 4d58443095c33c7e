#include "octree/normals/surface/board_ends.h"

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

/// Sines of the least angles between the ray to the station and the planes of the face and of the end.
constexpr double kBehindFace = 0.1, kBeforeEnd = 0.03;
/// The outermost points of a face lie on the border of the end, if they are the end's: so far from it, in the
/// distance of their own border.
constexpr float kAtEdge = 0.2f;

}  // namespace

void take_seen_ends(ChunkSurface& surface, std::span<const glm::dvec3> ray_of_site) {
    auto line = surface.lines.begin();
    for (SideNormal& side : surface.sides) {
        while (line != surface.lines.end() && line->site < side.site) ++line;
        if (line == surface.lines.end()) break;
        if (line->site != side.site) continue;
        const glm::dvec3& ray = ray_of_site[side.site];
        const double range = glm::length(ray);
        if (!(glm::dot(glm::dvec3(side.layered), ray) > kBehindFace * range &&
              glm::dot(glm::dvec3(line->toward), ray) > kBeforeEnd * range))
            continue;
        side.normal = line->toward;
        surface.normals[side.site] = side.normal;
        *line = {side.site,     side.normal,    -side.layered, kAtEdge * line->distance,
                 Beyond::falls, line->most_area};
    }
}

}  // namespace lucarne::octree
