#pragma once

#include <array>
#include <vector>

#include "octree/normals/neighbours/neighbours.h"

namespace lucarne::octree {

/// The edges of the neighbourhood graph along which orientation is handed on: the nearest few, and some
/// farther ones, which lead from one scan line to the next where a line is much denser than the lines are
/// apart.
inline constexpr size_t kSiteEdges = 8;
inline constexpr uint32_t kNoSite = UINT32_MAX;
using SiteEdges = std::array<uint32_t, kSiteEdges>;  ///< own sites, kNoSite where there are fewer

/// An edge of the graph that leaves the chunk.
struct BorderEdge {
    uint32_t site = 0;
    PointRef other;
    glm::vec3 offset{0.0f};  ///< from the site to the other point
};

/// The surface at each site of a chunk.
struct ChunkSurface {
    std::vector<glm::vec3> normals;  ///< zero: no stable plane
    std::vector<float> areas;        ///< of the site, to be shared by its points; 0: unknown
    std::vector<SiteEdges> edges;
    std::vector<BorderEdge> border;  ///< sorted by site and other point
    /// Sites whose share is that of a sparse surface beside a dense patch; sorted.
    std::vector<uint32_t> apart;
};

/// Normals and areas of all sites from `k` neighbours, and from four times as many where those leave the
/// normal uncertain.
Result<ChunkSurface> estimate_surface(ChunkNeighbours& neighbours, size_t k);

}  // namespace lucarne::octree
