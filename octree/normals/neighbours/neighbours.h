#pragma once

#include <functional>
#include <span>
#include <vector>

#include "octree/normals/neighbours/chunk_cache.h"
#include "octree/normals/neighbours/point_index.h"

namespace lucarne::octree {

/// A point by its chunk and its place in the chunk's stored order.
struct PointRef {
    uint32_t chunk = 0, index = 0;
};

/// The true nearest neighbours, over the whole cloud, of the points of one chunk: the chunk's own index
/// first, then one over a halo from the chunks around as well, for those points whose k-th neighbour is
/// farther than another chunk.
///
/// Works on distinct locations ("sites"): points at the same place (by the thousand, in merged scans) are one
/// site, else they would fill each other's neighbourhoods. Sites are numbered along a Morton curve, so that
/// work on consecutive sites stays in the cache. Site numbers from site_count() on are of the halo.
class ChunkNeighbours {
 public:
    /// `halo_bytes` bounds what is taken of the chunks around.
    static Result<ChunkNeighbours> load(ChunkCache& cache, size_t chunk, NeighbourSearch search,
                                        uint64_t halo_bytes);

    size_t site_count() const { return sites_.size(); }
    size_t point_count() const { return order_.size(); }
    glm::dvec3 position(uint32_t site) const {
        return site < sites_.size() ? sites_[site] : halo_[site - sites_.size()];
    }
    /// The stored indices of the points at an own site, ascending.
    std::span<const uint32_t> members(uint32_t site) const {
        return std::span(order_).subspan(first_[site], first_[site + 1] - first_[site]);
    }
    bool is_halo(uint32_t site) const { return site >= sites_.size(); }
    const PointRef& halo_point(uint32_t site) const { return halo_points_[site - sites_.size()]; }

    class Surroundings;
    /// Takes the `k` sites nearest to `site`, itself included, nearest first. `exact` is false where the
    /// surroundings are so empty that searching on was given up: what is known then is handed over. Returns
    /// 0, or the radius that it must know to go on: then it is called again when that is known.
    using Visit =
        std::function<double(uint32_t site, const Patch& nearest, bool exact, Surroundings& around)>;
    /// Calls `visit` for all sites until it is satisfied, in parallel and in any order; halo sites are valid
    /// inside `visit` only. Errors: a chunk that cannot be read.
    Result<void> search(size_t k, const Visit& visit);
    void drop_indices();  ///< frees what only `search` needs

 private:
    struct Around {  ///< another chunk with points
        uint32_t chunk;
        Box bounds;
        double distance2;  ///< of the two boxes
    };
    struct Pending {  ///< a site that must know more
        uint32_t site;
        double radius;
    };
    ChunkNeighbours(ChunkCache& cache, size_t chunk, NeighbourSearch search, uint64_t halo_bytes)
        : cache_(&cache), chunk_(chunk), search_(search), halo_bytes_(halo_bytes) {}
    void sort_sites(const std::vector<glm::dvec3>& points);
    void find_around();
    bool reaches_out(uint32_t site, double distance2) const;
    /// Fills the halo with all points of other chunks within `radius` of `pending`; false where that would
    /// take too many.
    Result<bool> load_halo(std::span<const Pending> pending, double radius);
    double first_radius(std::span<const Pending> pending) const;
    Result<void> search_beyond(std::vector<Pending> pending, size_t k, const Visit& visit);

    ChunkCache* cache_;
    size_t chunk_;
    NeighbourSearch search_;
    uint64_t halo_bytes_;
    Box box_;
    PointArrays sites_;
    std::vector<uint32_t> order_, first_;  ///< points by site; where each site's begin
    std::vector<Around> around_;           ///< by distance
    std::unique_ptr<PointIndex> index_, halo_index_;
    PointArrays halo_;
    std::vector<PointRef> halo_points_;
};

/// What can be asked about a site and around it while it is visited. One for a few sites close together,
/// which share what was gathered around them.
class ChunkNeighbours::Surroundings {
 public:
    /// `halo`: the radius within which the halo holds all points; 0: there is none yet.
    Surroundings(const ChunkNeighbours& neighbours, double halo) : of_(neighbours), halo_(halo) {}

    /// Goes to the next few sites: `reach` is how far neighbours may be, a guess.
    void begin(std::span<const uint32_t> sites, size_t k);
    /// Goes to a site, and finds its `k` nearest sites among the known ones, itself included.
    const Patch& visit(uint32_t site, size_t k);

    /// Whether all points nearer than `radius` are at hand (or no more can be).
    bool knows(double radius) const;
    /// All points within a radius of the site, in no particular order, among others.
    struct View {
        const Tile& tile;
        glm::vec3 centre;  ///< the site, relative to the tile's origin
        double radius;     ///< that asked for; where those within it are very many, a smaller one
    };
    View around(double radius);
    /// Takes those into `patch`. Returns the radius.
    double within(double radius, Patch& patch);
    /// The `k` nearest sites of those known.
    void nearest(size_t k, Patch& patch);

 private:
    struct Gathered {
        Tile tile;
        double radius = -1;  ///< no point within it of the box is missing; < 0: nothing is gathered
        bool all = false;    ///< there are no more
        double crowded = std::numeric_limits<double>::infinity();  ///< this radius was too wide
        void clear() { *this = {std::move(tile)}; }
    };
    bool gather(const Box& box, double radius, size_t most, Gathered& gathered) const;
    bool find_shared(size_t k);
    bool find_wide(size_t k, Patch& patch);

    const ChunkNeighbours& of_;
    double halo_;
    Box box_{};             ///< of the sites
    Gathered near_, wide_;  ///< around all sites
    Gathered own_;          ///< around the one visited, when it is alone
    uint32_t site_ = 0;     ///< the one visited
    bool alone_ = false;    ///< too far from others, or too near, for what is gathered around all
    Patch candidates_, nearest_;
    double guess_ = 0, farthest_ = 0;  ///< of the reach in this group; the farthest found so far
    glm::dvec3 previous_{0.0};         ///< the site before, and how far its nearest were
    double previous_reach_ = -1;
};

}  // namespace lucarne::octree
