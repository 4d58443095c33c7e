#include "octree/normals/surface/edge_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr float kAlikePlanes = 0.94f;  ///< |n.n'| of two sites on one plane: 20 degrees
constexpr float kAlikeLines = 0.94f;   ///< of the directions to two lines that are one
constexpr float kAlikeToTurn = 0.8f;   ///< of the directions of lines that turn each other
/// A line is handed on to sites from which it is at most that many times as far as from its own.
constexpr float kHandedOn = 3.0f;

/// Returns a line as another site sees it whose plane has the normal `n`. The distance is negative where that
/// site lies beyond the line, and NaN where the planes differ. `apart`: from the line's site to the other.
SiteLine seen_from(uint32_t other, const glm::vec3& n, const glm::dvec3& apart, const SiteLine& line) {
    const float facing = glm::dot(line.normal, n);
    SiteLine seen{other, n, glm::normalize(line.toward - n * glm::dot(n, line.toward)), NAN, line.beyond};
    if (facing < 0) seen.beyond = turned(line.beyond);
    if (std::abs(facing) > kAlikePlanes)
        seen.distance = line.distance - static_cast<float>(glm::dot(glm::dvec3(line.toward), apart));
    return seen;
}

/// Turns the lines of neighbours that run alike toward their mean direction. A site's own depends on where
/// its few neighbours happen to lie.
void turn_alike(const ChunkNeighbours& neighbours, const std::vector<uint32_t>& line_of,
                ChunkSurface& surface) {
    std::vector<glm::vec3> turned;
    for (const SiteLine& line : surface.lines) {
        glm::vec3 sum = line.toward;
        for (const uint32_t other : surface.edges[line.site]) {
            if (other == kNoSite || line_of[other] == kNoSite) continue;
            const glm::dvec3 apart = neighbours.position(other) - neighbours.position(line.site);
            const SiteLine seen = seen_from(line.site, line.normal, -apart, surface.lines[line_of[other]]);
            if (!std::isnan(seen.distance) && glm::dot(seen.toward, line.toward) > kAlikeToTurn)
                sum += seen.toward;
        }
        turned.push_back(glm::normalize(sum));
    }
    for (size_t i = 0; i < turned.size(); ++i) surface.lines[i].toward = turned[i];
}

}  // namespace

void agree_on_lines(const ChunkNeighbours& neighbours, ChunkSurface& surface) {
    std::vector<uint32_t> line_of(surface.normals.size(), kNoSite);
    for (uint32_t i = 0; i < surface.lines.size(); ++i) line_of[surface.lines[i].site] = i;
    turn_alike(neighbours, line_of, surface);
    std::vector<SiteLine> agreed, handed;
    for (const SiteLine& line : surface.lines) {
        std::array<float, kSiteEdges + 1> distances{line.distance};
        size_t count = 1;
        for (const uint32_t other : surface.edges[line.site]) {
            if (other == kNoSite) continue;
            const glm::dvec3 apart = neighbours.position(other) - neighbours.position(line.site);
            if (line_of[other] != kNoSite) {
                const SiteLine seen =
                    seen_from(line.site, line.normal, -apart, surface.lines[line_of[other]]);
                if (seen.distance > 0 && glm::dot(seen.toward, line.toward) > kAlikeLines)
                    distances[count++] = seen.distance;
            } else if (surface.normals[other] != glm::vec3(0.0f)) {
                const SiteLine seen = seen_from(other, surface.normals[other], apart, line);
                if (seen.distance > 0 && seen.distance < kHandedOn * line.distance) handed.push_back(seen);
            }
        }
        const auto middle = distances.begin() + static_cast<ptrdiff_t>(count / 2);
        std::nth_element(distances.begin(), middle, distances.begin() + static_cast<ptrdiff_t>(count));
        agreed.push_back(line);
        agreed.back().distance = *middle;
    }
    // Of several lines that a site is handed, the median one is taken.
    std::stable_sort(handed.begin(), handed.end(), [](const SiteLine& a, const SiteLine& b) {
        return a.site != b.site ? a.site < b.site : a.distance < b.distance;
    });
    for (size_t first = 0, end = 0; first < handed.size(); first = end) {
        while (end < handed.size() && handed[end].site == handed[first].site) ++end;
        agreed.push_back(handed[first + (end - first) / 2]);
    }
    std::stable_sort(agreed.begin(), agreed.end(),
                     [](const SiteLine& a, const SiteLine& b) { return a.site < b.site; });
    surface.lines = std::move(agreed);
}

}  // namespace lucarne::octree
