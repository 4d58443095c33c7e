#pragma once

#include <array>
#include <limits>
#include <vector>

#include "octree/normals/neighbours/neighbours.h"
#include "octree/normals/surface/border.h"

namespace lucarne::octree {

/// The number of edges per site in the neighbourhood graph along which orientation is propagated: to the
/// nearest few sites and to some farther ones. The farther ones lead from one scan line to the next where
/// points are much closer along a line than the lines are apart.
inline constexpr size_t kSiteEdges = 8;
inline constexpr uint32_t kNoSite = UINT32_MAX;
using SiteEdges = std::array<uint32_t, kSiteEdges>;  ///< sites of the chunk; kNoSite where there are fewer

/// An edge of the graph that leaves the chunk.
struct BorderEdge {
    uint32_t site = 0;
    PointRef other;
    glm::vec3 offset{0.0f};  ///< from the site to the other point
};

/// A site whose neighbours are much sparser than a surface nearby.
struct CrowdedSite {
    uint32_t site = 0;
    /// Points near the site over the number that a sheet as sparse as the site's neighbourhood has there.
    float crowding = 0;
};

/// The normal of a site's own side of a crease.
struct SideNormal {
    uint32_t site = 0;
    glm::vec3 normal{0.0f};  ///< the sign is arbitrary
    /// Of a site at the border of one face of a board: unit, along the normal, to the other face; else zero.
    glm::vec3 layered{0.0f};
};

/// The line at which a site's surface ends: at a crease or a border.
struct SiteLine {
    uint32_t site = 0;
    glm::vec3 normal{0.0f};  ///< of the site's plane (that of its side), unit
    glm::vec3 toward{0.0f};  ///< unit, in the plane: to the line, at right angles
    float distance = 0;
    Beyond beyond = Beyond::nothing;  ///< seen from the side to which `normal` points
    /// Largest share of the site if the line is an outer edge: finite where several planes lie beyond it, of
    /// which one line cannot follow the edges.
    float most_area = std::numeric_limits<float>::infinity();
};

/// The estimated surface at each site of a chunk.
struct ChunkSurface {
    std::vector<glm::vec3> normals;  ///< zero: no stable plane
    /// Sharper normals of sites at creases, sorted by site. `normals` has the normal of the whole
    /// neighbourhood there, which turns gradually over a crease, so that orientation can follow it across.
    std::vector<SideNormal> sides;
    std::vector<SiteLine> lines;  ///< sorted by site, at most one a site
    std::vector<float> areas;     ///< of the site, to be divided among its points; 0: unknown
    std::vector<SiteEdges> edges;
    std::vector<BorderEdge> border;  ///< sorted by site and other point
    /// Sites that were accepted as a sparse surface beside a dense patch, although they look isolated;
    /// sorted.
    std::vector<uint32_t> apart;
    std::vector<CrowdedSite> crowded;  ///< sorted by site
};

/// Estimates normals and areas of all sites from `k` neighbours, and from about four times as many where
/// those leave the normal uncertain.
Result<ChunkSurface> estimate_surface(ChunkNeighbours& neighbours, size_t k);

}  // namespace lucarne::octree
