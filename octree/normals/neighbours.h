#pragma once

#include <functional>
#include <span>
#include <vector>

#include "octree/normals/chunk_cache.h"
#include "octree/normals/point_index.h"

namespace lucarne::octree {

/// A point by its chunk and its place in the chunk's stored order.
struct PointRef {
    uint32_t chunk = 0, index = 0;
};

/// The true nearest neighbours, over the whole cloud, of the points of one chunk: the chunk's own tree first,
/// then a tree over a halo from the chunks around, for those points whose k-th neighbour is farther than
/// another chunk.
///
/// Works on distinct locations ("sites"): points at the same place (by the thousand, in merged scans) are one
/// site, else they would fill each other's neighbourhoods. Sites are numbered along a Morton curve, so that
/// work on consecutive sites stays in the cache. Site numbers from site_count() on are of the halo.
class ChunkNeighbours {
 public:
    /// `halo_bytes` bounds what is taken of the chunks around.
    static Result<ChunkNeighbours> load(ChunkCache& cache, size_t chunk, uint64_t halo_bytes);

    size_t site_count() const { return sites_.size(); }
    size_t point_count() const { return order_.size(); }
    const glm::dvec3& position(uint32_t site) const {
        return site < sites_.size() ? sites_[site] : halo_[site - sites_.size()];
    }
    /// The stored indices of the points at an own site, ascending.
    std::span<const uint32_t> members(uint32_t site) const {
        return std::span(order_).subspan(first_[site], first_[site + 1] - first_[site]);
    }
    bool is_halo(uint32_t site) const { return site >= sites_.size(); }
    const PointRef& halo_point(uint32_t site) const { return halo_points_[site - sites_.size()]; }
    /// What can be asked about the surroundings of a site while it is visited.
    class Surroundings {
     public:
        /// Whether all points nearer than `radius` are at hand (or no more can be).
        bool knows(double radius) const;
        /// The nearest points within `radius` of the site that `wanted` (asked with their offset) lets
        /// through, nearest first, into `nearest`; how many there are.
        size_t nearest(double radius, const std::function<bool(const glm::vec3& offset)>& wanted,
                       std::span<Neighbour> nearest) const;
        glm::vec3 offset(uint32_t other) const { return glm::vec3(of.position(other) - of.position(site)); }

     private:
        friend class ChunkNeighbours;
        Surroundings(const ChunkNeighbours& neighbours, uint32_t centre, double known)
            : of(neighbours), site(centre), halo(known) {}
        const ChunkNeighbours& of;
        uint32_t site;
        double halo;  ///< the radius within which the halo holds all points
    };
    /// Takes the `k` sites nearest to `site`, itself included, nearest first. `exact` is false where the
    /// surroundings are so empty that searching on was given up: what is known then is handed over. Returns
    /// 0, or the radius that it must know to go on: then it is called again when that is known.
    using Visit = std::function<double(uint32_t site, std::span<const Neighbour> nearest, bool exact,
                                       const Surroundings& around)>;
    /// Calls `visit` for each of `sites` until it is satisfied, in parallel and in any order; halo sites are
    /// valid inside `visit` only. Errors: a chunk that cannot be read.
    Result<void> search(std::span<const uint32_t> sites, size_t k, const Visit& visit);
    void drop_indices();  ///< frees what only `search` needs

 private:
    struct Around {  ///< another chunk with points
        uint32_t chunk;
        Box bounds;
        double distance2;  ///< of the two boxes
    };
    ChunkNeighbours(ChunkCache& cache, size_t chunk, uint64_t halo_bytes)
        : cache_(&cache), chunk_(chunk), halo_bytes_(halo_bytes) {}
    void sort_sites(const std::vector<glm::dvec3>& points);
    void find_around();
    bool reaches_out(uint32_t site, double distance2) const;
    /// Fills the halo with all points of other chunks within `radius` of `pending`; false where that would
    /// take too many.
    Result<bool> load_halo(std::span<const uint32_t> pending, double radius);
    Result<void> search_beyond(std::vector<uint32_t> pending, double radius, size_t k, const Visit& visit);

    ChunkCache* cache_;
    size_t chunk_;
    uint64_t halo_bytes_;
    Box box_;
    std::vector<glm::dvec3> sites_;
    std::vector<uint32_t> order_, first_;  ///< points by site; where each site's begin
    std::vector<Around> around_;           ///< by distance
    PointIndex index_;
    std::vector<glm::dvec3> halo_;
    std::vector<PointRef> halo_points_;
    PointIndex halo_index_;
};

}  // namespace lucarne::octree
