#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/surface/chunk_surface.h"

namespace lucarne::octree {

/// How two patches agree: a sum over edges between them, > 0 for the same orientation.
struct PatchVote {
    uint32_t a = 0, b = 0;
    double same = 0;
};

/// Pieces of smooth surface of a chunk.
struct Patches {
    std::vector<uint32_t> of;  ///< of each site; sites without a normal have 0
    uint32_t count = 1;
    std::vector<PatchVote> votes;  ///< those of one pair add up
};

/// The neighbourhood graph of a chunk.
struct PatchGraph {
    std::span<const SiteEdges> edges;
    /// Of each site: bit e tells that edge e runs along a surface that does not turn.
    std::span<const uint8_t> along;
    /// Returns how the normals at the ends of edge e of a site agree, > 0 for the same orientation; 0 where
    /// that is not known, or is known from the other end.
    std::function<float(uint32_t site, uint32_t e)> same;
};
static_assert(kSiteEdges <= 8);

/// Divides the sites into pieces of at most `size` sites over which the normals turn little. Pieces that are
/// far smaller join the neighbours with which they agree best, as many as there are, which may flip normals;
/// the votes are those after that.
Patches divide_into_patches(const PatchGraph& graph, std::vector<glm::vec3>& normals, size_t size);

}  // namespace lucarne::octree
