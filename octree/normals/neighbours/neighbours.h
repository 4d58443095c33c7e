#pragma once

#include <functional>
#include <span>
#include <vector>

#include "octree/normals/neighbours/chunk_cache.h"
#include "octree/normals/neighbours/point_index.h"

namespace lucarne::octree {

/// Identifies a point by its chunk and its index in the chunk's stored order.
struct PointRef {
    uint32_t chunk = 0, index = 0;
};

/// Finds the true nearest neighbours, over the whole cloud, of the points of one chunk. It searches the
/// chunk's own index first. Points whose k-th neighbour is farther than another chunk are searched again with
/// an index of a halo: points of the surrounding chunks.
///
/// Works on distinct locations ("sites"): points at the same position (merged scans have thousands) are one
/// site, because otherwise they would fill each other's neighbourhoods. Sites are numbered along a Morton
/// curve, so that work on consecutive sites stays in the CPU's cache. Site numbers from site_count() on
/// belong to the halo.
class ChunkNeighbours {
 public:
    /// `halo_bytes` limits the memory for points of surrounding chunks.
    static Result<ChunkNeighbours> load(ChunkCache& cache, size_t chunk, NeighbourSearch search,
                                        uint64_t halo_bytes);

    size_t site_count() const { return sites_.size(); }
    size_t point_count() const { return order_.size(); }
    glm::dvec3 position(uint32_t site) const {
        return site < sites_.size() ? sites_[site] : halo_[site - sites_.size()];
    }
    /// Returns the stored indices of the points at a site of the chunk, ascending.
    std::span<const uint32_t> members(uint32_t site) const {
        return std::span(order_).subspan(first_[site], first_[site + 1] - first_[site]);
    }
    bool is_halo(uint32_t site) const { return site >= sites_.size(); }
    const PointRef& halo_point(uint32_t site) const { return halo_points_[site - sites_.size()]; }

    class Surroundings;
    /// Receives the `k` sites nearest to `site`, itself included, nearest first. `exact` is false where the
    /// search was given up because the surroundings are too empty; `nearest` then holds what is known.
    /// Returns 0, or the radius that it must know to continue: then it is called again once that is known.
    using Visit =
        std::function<double(uint32_t site, const Patch& nearest, bool exact, Surroundings& around)>;
    /// Calls `visit` for all sites until it returns 0, in parallel and in any order. Halo sites are valid
    /// only inside `visit`. Errors: a chunk that cannot be read.
    Result<void> search(size_t k, const Visit& visit);
    void drop_indices();  ///< frees what only `search` needs

 private:
    struct Around {  ///< another chunk with points
        uint32_t chunk;
        Box bounds;
        double distance2;  ///< squared distance between the two boxes
    };
    struct Pending {  ///< a site that must know its surroundings farther out
        uint32_t site;
        double radius;
    };
    ChunkNeighbours(ChunkCache& cache, size_t chunk, NeighbourSearch search, uint64_t halo_bytes)
        : cache_(&cache), chunk_(chunk), search_(search), halo_bytes_(halo_bytes) {}
    void sort_sites(const std::vector<glm::dvec3>& points);
    void find_around();
    bool reaches_out(uint32_t site, double distance2) const;
    /// Fills the halo with all points of other chunks within `radius` of `pending`. Returns false if these
    /// are too many.
    Result<bool> load_halo(std::span<const Pending> pending, double radius);
    double first_radius(std::span<const Pending> pending) const;
    Result<void> search_beyond(std::vector<Pending> pending, size_t k, const Visit& visit);

    ChunkCache* cache_;
    size_t chunk_;
    NeighbourSearch search_;
    uint64_t halo_bytes_;
    Box box_;
    PointArrays sites_;
    /// Points by site; the index in order_ at which each site's points begin.
    std::vector<uint32_t> order_, first_;
    std::vector<Around> around_;  ///< sorted by distance
    std::unique_ptr<PointIndex> index_, halo_index_;
    PointArrays halo_;
    std::vector<PointRef> halo_points_;
};

/// Answers questions about a site and its surroundings while it is visited. One object serves a group of
/// close sites, which share the points gathered around them.
class ChunkNeighbours::Surroundings {
 public:
    /// `halo`: the radius within which the halo holds all points; 0: no halo yet.
    Surroundings(const ChunkNeighbours& neighbours, double halo) : Surroundings(neighbours, halo, halo) {}
    /// The same, where the search is given up: `halo` is taken for known, and only `certain` is.
    Surroundings(const ChunkNeighbours& neighbours, double halo, double certain)
        : of_(neighbours), halo_(halo), certain_(certain) {}

    /// Starts a group of sites. Estimates how far their neighbours may be.
    void begin(std::span<const uint32_t> sites, size_t k);
    /// Goes to a site and finds its `k` nearest among the known sites, itself included.
    const Patch& visit(uint32_t site, size_t k);

    /// The radius within which all points are known even where the search was given up.
    double certain() const { return certain_; }
    /// Whether all points nearer than `radius` are known (or no more can be).
    bool knows(double radius) const;
    /// The same, also where the search was given up.
    bool surely_knows(double radius) const;
    /// A superset of the points within a radius of the site, in no particular order.
    struct View {
        const Tile& tile;
        glm::vec3 centre;  ///< the site, relative to the tile's origin
        double radius;     ///< the requested radius, or a smaller one where it holds too many points
    };
    View around(double radius);
    /// Copies the points within `radius` into `patch`. Returns the radius, which may be smaller, as in View.
    double within(double radius, Patch& patch);
    /// Finds the `k` nearest of the known sites.
    void nearest(size_t k, Patch& patch);

 private:
    struct Gathered {
        Tile tile;
        double radius = -1;  ///< all points within it of the box are gathered; < 0: nothing is gathered
        bool all = false;    ///< all points there are have been gathered
        double crowded = std::numeric_limits<double>::infinity();  ///< the radius that held too many points
        void clear() { *this = {std::move(tile)}; }
    };
    bool gather(const Box& box, double radius, size_t most, Gathered& gathered) const;
    bool find_shared(size_t k);
    bool find_wide(size_t k, Patch& patch);

    const ChunkNeighbours& of_;
    double halo_, certain_;
    Box box_{};             ///< bounds of the group's sites
    Gathered near_, wide_;  ///< gathered around all sites of the group
    Gathered own_;          ///< gathered around the visited site alone
    uint32_t site_ = 0;     ///< the visited site
    /// The site is too far from the others, or too near, for what is gathered around the group.
    bool alone_ = false;
    Patch candidates_, nearest_;
    /// Estimated reach of the group's neighbours; the farthest found so far.
    double guess_ = 0, farthest_ = 0;
    glm::dvec3 previous_{0.0};  ///< the previous site; previous_reach_ is how far its nearest were
    double previous_reach_ = -1;
};

}  // namespace lucarne::octree
