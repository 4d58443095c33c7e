#include "octree/normals/neighbours/neighbours.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <unordered_set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/neighbours/leaf_index.h"
#include "octree/tree/key.h"

namespace lucarne::octree {
namespace {

constexpr size_t kGroups = 96;                        ///< groups of sites in a piece of parallel work
constexpr size_t kMostNeighbours = 128;               ///< most neighbours of a site
constexpr size_t kMostChunkPoints = size_t{1} << 29;  ///< sites times edges must fit into 32 bits
/// A halo is widened to at most this many chunk sizes: an isolated point must not load the whole cloud.
constexpr double kWidestHalo = 4.0;
/// A halo holds at most this many points per point of the chunk, but kLeastHalo are always allowed.
constexpr size_t kHaloShare = 2, kLeastHalo = size_t{1} << 18;
/// Memory of a halo point: found, sorted, and in a tree. There is always room for kFewestHalo points: 2 MiB.
constexpr uint64_t kHaloPointBytes = 128;
constexpr uint64_t kFewestHalo = 1 << 14;
constexpr int kMostNarrowings = 6;  ///< how often a halo with too many points is narrowed to a quarter
/// Number of sites that share the points gathered around them.
constexpr size_t kGroupSites = 16;

double distance2(const Box& a, const Box& b) {
    const glm::dvec3 gap = glm::max(glm::max(a.min - b.max, b.min - a.max), glm::dvec3(0.0));
    return glm::dot(gap, gap);
}
double distance2(const glm::dvec3& p, const Box& b) {
    return distance2(Box{p, p}, b);
}

double widest(const Box& box) {
    const glm::dvec3 size = box.max - box.min;
    return std::max({size.x, size.y, size.z});
}

Box bounds_of(std::span<const glm::dvec3> points) {
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (const auto& p : points) {
        box.min = glm::min(box.min, p);
        box.max = glm::max(box.max, p);
    }
    return box;
}

/// The set of a grid's cells that lie within one cell of given points.
class CellSet {
 public:
    CellSet(const Box& box, double cell)
        : origin_(box.min),
          cell_(std::max({cell, widest(box) / kMostCell, std::numeric_limits<double>::min()})) {}
    void add_around(const glm::dvec3& p) {
        const auto c = coordinates(p);
        if (!centres_.insert(morton(c[0], c[1], c[2])).second) return;
        for (int64_t x = c[0] - 1; x <= c[0] + 1; ++x)
            for (int64_t y = c[1] - 1; y <= c[1] + 1; ++y)
                for (int64_t z = c[2] - 1; z <= c[2] + 1; ++z)
                    cells_.insert(
                        morton(static_cast<uint64_t>(x), static_cast<uint64_t>(y), static_cast<uint64_t>(z)));
    }
    bool contains(const glm::dvec3& p) const {
        const auto c = coordinates(p);
        return cells_.contains(morton(c[0], c[1], c[2]));
    }

 private:
    /// Leaves a margin of two cells below, so that no neighbour cell is negative.
    std::array<int64_t, 3> coordinates(const glm::dvec3& p) const {
        const glm::dvec3 c = glm::clamp(glm::floor((p - origin_) / cell_), -1.0, kMostCell) + 2.0;
        return {static_cast<int64_t>(c.x), static_cast<int64_t>(c.y), static_cast<int64_t>(c.z)};
    }
    static constexpr double kMostCell = 1 << 20;
    glm::dvec3 origin_;
    double cell_;
    std::unordered_set<uint64_t> centres_, cells_;
};

}  // namespace

Result<ChunkNeighbours> ChunkNeighbours::load(ChunkCache& cache, size_t chunk, NeighbourSearch search,
                                              uint64_t halo_bytes) {
    ChunkNeighbours loaded(cache, chunk, search, halo_bytes);
    LUCARNE_ASSIGN(const auto points, cache.positions(chunk));
    if (points->size() >= kMostChunkPoints) return failed("normals", "a chunk of more than 2^29 points");
    loaded.sort_sites(*points);
    loaded.box_ = bounds_of(*points);
    loaded.find_around();
    return loaded;
}

void ChunkNeighbours::sort_sites(const std::vector<glm::dvec3>& points) {
    order_ = morton_order(points);
    sites_.reserve(points.size());
    first_.reserve(points.size() + 1);
    for (size_t at = 0; at < order_.size(); ++at) {
        const glm::dvec3& p = points[order_[at]];
        if (at > 0 && points[order_[at - 1]] == p) continue;
        first_.push_back(static_cast<uint32_t>(at));
        sites_.push_back(p);
    }
    first_.push_back(static_cast<uint32_t>(order_.size()));
}

void ChunkNeighbours::find_around() {
    const ChunkAccess& chunks = cache_->chunks();
    for (size_t other = 0; other < chunks.chunk_count(); ++other) {
        if (other == chunk_ || chunks.point_count(other) == 0) continue;
        const Box bounds = cache_->bounds(other);
        around_.push_back({static_cast<uint32_t>(other), bounds, distance2(box_, bounds)});
    }
    std::sort(around_.begin(), around_.end(), [](const Around& a, const Around& b) {
        return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.chunk < b.chunk;
    });
}

bool ChunkNeighbours::reaches_out(uint32_t site, double reach2) const {
    for (const Around& other : around_) {
        if (other.distance2 >= reach2) return false;
        if (distance2(sites_[site], other.bounds) < reach2) return true;
    }
    return false;
}

Result<void> ChunkNeighbours::search(size_t k, const Visit& visit) {
    assert(k <= kMostNeighbours);
    std::vector<uint32_t> starts;  // starts of the groups
    if (search_ == NeighbourSearch::leaf) {
        auto index = std::make_unique<LeafIndex>(sites_);
        starts.assign(index->leaves().begin(), index->leaves().end());
        index_ = std::move(index);
    } else {
        index_ = make_index(search_, sites_);
        for (size_t i = 0; i < sites_.size(); i += kGroupSites) starts.push_back(static_cast<uint32_t>(i));
        starts.push_back(static_cast<uint32_t>(sites_.size()));
    }
    std::mutex mutex;
    std::vector<Pending> pending;
    parallel_ranges(starts.size() - 1, kGroups, [&](size_t first, size_t last) {
        std::vector<Pending> out;
        std::vector<uint32_t> sites;
        Surroundings around(*this, 0.0);
        for (size_t group = first; group < last; ++group) {
            sites.resize(starts[group + 1] - starts[group]);
            std::iota(sites.begin(), sites.end(), starts[group]);
            around.begin(sites, k);
            for (const uint32_t site : sites) {
                const Patch& nearest = around.visit(site, k);
                const double reach2 = nearest.count == k ? nearest.distance2[k - 1] : kInfinity;
                double needed = std::sqrt(reach2);
                if (!reaches_out(site, reach2)) needed = visit(site, nearest, true, around);
                if (needed > 0) out.push_back({site, needed});
            }
        }
        const std::lock_guard lock(mutex);
        pending.insert(pending.end(), out.begin(), out.end());
    });
    if (pending.empty()) return {};
    std::sort(pending.begin(), pending.end(),
              [](const Pending& a, const Pending& b) { return a.site < b.site; });
    return search_beyond(std::move(pending), k, visit);
}

/// Returns the first radius of the halo: the one that half of the sites need.
double ChunkNeighbours::first_radius(std::span<const Pending> pending) const {
    const double size = widest(cache_->bounds(chunk_));
    std::vector<double> reaches;
    for (const auto& [site, reach] : pending)
        if (std::isfinite(reach)) reaches.push_back(reach);
    if (reaches.empty()) return size / 64;
    const auto median = reaches.begin() + static_cast<ptrdiff_t>(reaches.size() / 2);
    std::nth_element(reaches.begin(), median, reaches.end());
    return std::min(size * kWidestHalo, *median);
}

Result<void> ChunkNeighbours::search_beyond(std::vector<Pending> pending, size_t k, const Visit& visit) {
    double radius = first_radius(pending), widest_halo = kWidestHalo * widest(cache_->bounds(chunk_));
    for (int narrowed = 0; !pending.empty();) {
        LUCARNE_ASSIGN(const bool complete, load_halo(pending, radius));
        if (!complete &&
            narrowed < kMostNarrowings) {  // dense surroundings: what is near them is served by less
            widest_halo = radius /= 4;
            ++narrowed;
            continue;
        }
        const bool last_try = !complete || radius >= widest_halo;
        const auto ask = [&](uint32_t site, Surroundings& around) {
            const Patch& nearest = around.visit(site, k);
            const double reach = nearest.count == k ? std::sqrt(double{nearest.distance2[k - 1]}) : kInfinity;
            const bool exact = complete && (reach <= radius || !reaches_out(site, reach * reach));
            return exact || last_try ? visit(site, nearest, exact, around) : reach;
        };
        std::mutex mutex;
        std::vector<Pending> still;
        parallel_ranges(pending.size(), kGroups * kGroupSites / 4, [&](size_t first, size_t last) {
            std::vector<uint32_t> sites;
            std::vector<Pending> out;
            Surroundings around(*this, last_try ? kInfinity : radius, complete ? radius : 0.0);
            for (size_t i = first; i < last;) {
                sites.clear();
                for (; i < last && sites.size() < kGroupSites &&
                       (sites.empty() || pending[i].site - sites.front() < 2 * kGroupSites);
                     ++i)
                    sites.push_back(pending[i].site);
                around.begin(sites, k);
                for (const uint32_t site : sites)
                    if (const double needed = ask(site, around); needed > 0) out.push_back({site, needed});
            }
            const std::lock_guard lock(mutex);
            still.insert(still.end(), out.begin(), out.end());
        });
        std::sort(still.begin(), still.end(),
                  [](const Pending& a, const Pending& b) { return a.site < b.site; });
        double farthest = 0;
        for (const Pending& p : still) farthest = std::max(farthest, p.radius);
        pending = std::move(still);
        // Tries four times the radius, or one that is certainly enough. Positions too close for floats are at
        // distance 0.
        radius = std::min({radius > 0 ? 4 * radius : farthest, farthest, widest_halo});
    }
    return {};
}

void ChunkNeighbours::drop_indices() {
    index_.reset();
    halo_index_.reset();
    halo_.release();
    std::vector<PointRef>().swap(halo_points_);
}

Result<bool> ChunkNeighbours::load_halo(std::span<const Pending> pending, double radius) {
    halo_index_.reset();
    halo_.clear();
    halo_points_.clear();
    std::vector<glm::dvec3> centres;
    for (const Pending& p : pending) centres.push_back(sites_[p.site]);
    Box region = bounds_of(centres);
    region.min -= radius;
    region.max += radius;
    CellSet cells(region, radius);
    for (const auto& p : centres) cells.add_around(p);

    const size_t most = std::min<uint64_t>(std::max(kLeastHalo, kHaloShare * sites_.size()),
                                           std::max(kFewestHalo, halo_bytes_ / kHaloPointBytes));
    std::vector<glm::dvec3> found;
    std::vector<PointRef> refs;
    for (const Around& other : around_) {
        if (other.distance2 > radius * radius) break;
        std::vector<glm::dvec3> near;
        for (const auto& p : centres)
            if (distance2(p, other.bounds) <= radius * radius) near.push_back(p);
        if (near.empty()) continue;
        Box wanted = bounds_of(near);
        wanted.min -= radius;
        wanted.max += radius;
        LUCARNE_ASSIGN(const auto points, cache_->near(other.chunk, wanted));
        for (size_t i = 0; i < points.positions->size(); ++i) {
            const glm::dvec3& p = (*points.positions)[i];
            if (distance2(p, wanted) > 0 || !cells.contains(p)) continue;
            if (found.size() == most) return false;
            found.push_back(p);
            refs.push_back({other.chunk, points.index(i)});
        }
    }
    for (const uint32_t i : morton_order(found)) {
        if (halo_.size() > 0 && halo_[halo_.size() - 1] == found[i]) continue;
        halo_.push_back(found[i]);
        halo_points_.push_back(refs[i]);
    }
    halo_index_ = make_index(search_, halo_);
    return true;
}

}  // namespace lucarne::octree
