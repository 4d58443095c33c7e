#include "octree/normals/neighbours.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <tuple>
#include <unordered_set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/key.h"

namespace lucarne::octree {
namespace {

constexpr size_t kGrain = 2048;                       ///< sites a piece of parallel work
constexpr size_t kMostNeighbours = 128;               ///< per site, on the stack
constexpr size_t kMostChunkPoints = size_t{1} << 29;  ///< sites times edges must fit 32 bits
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A halo is widened to this many chunk sizes and no further: an isolated point must not load the world.
constexpr double kWidestHalo = 4.0;
/// A halo holds at most this many points per own site, but kLeastHalo anyway.
constexpr size_t kHaloShare = 2, kLeastHalo = size_t{1} << 18;
/// What a halo point takes: found, sorted, and in a tree. The fewest there is always room for: 2 MiB.
constexpr uint64_t kHaloPointBytes = 128;
constexpr uint64_t kFewestHalo = 1 << 14;
constexpr int kMostNarrowings = 6;  ///< tries of a halo a quarter as wide when there are more

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

bool less(const glm::dvec3& a, const glm::dvec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

Box bounds_of(std::span<const glm::dvec3> points) {
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (const auto& p : points) {
        box.min = glm::min(box.min, p);
        box.max = glm::max(box.max, p);
    }
    return box;
}

/// How far the k nearest of a point can be at most, from those of the one before: no farther than that one
/// and then its k nearest. Spares a search most of what it would take up only to drop it again.
struct SearchBound {
    glm::dvec3 previous{0.0};
    double reach = kInfinity;
    double limit2(const glm::dvec3& p) const {
        constexpr double kMoreThanRounding = 1 + 1e-9;
        const double farthest = (glm::distance(p, previous) + reach) * kMoreThanRounding;
        return farthest * farthest;
    }
};

/// The cells of a grid that lie within one cell of given points.
class CellSet {
 public:
    CellSet(const Box& box, double cell)
        : origin_(box.min),
          cell_(std::max({cell, widest(box) / (1 << 20), std::numeric_limits<double>::min()})) {}
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
    /// Two cells of margin below, so that no neighbour cell is negative.
    std::array<int64_t, 3> coordinates(const glm::dvec3& p) const {
        const glm::dvec3 c = glm::floor((p - origin_) / cell_) + 2.0;
        return {static_cast<int64_t>(c.x), static_cast<int64_t>(c.y), static_cast<int64_t>(c.z)};
    }
    glm::dvec3 origin_;
    double cell_;
    std::unordered_set<uint64_t> centres_, cells_;
};

}  // namespace

Result<ChunkNeighbours> ChunkNeighbours::load(ChunkCache& cache, size_t chunk, uint64_t halo_bytes) {
    ChunkNeighbours loaded(cache, chunk, halo_bytes);
    LUCARNE_ASSIGN(const auto points, cache.positions(chunk));
    if (points->size() >= kMostChunkPoints) return failed("normals", "a chunk of more than 2^29 points");
    loaded.sort_sites(*points);
    loaded.box_ = bounds_of(loaded.sites_);
    loaded.find_around();
    loaded.index_ = PointIndex(loaded.sites_);
    return loaded;
}

void ChunkNeighbours::sort_sites(const std::vector<glm::dvec3>& points) {
    const Box box = bounds_of(points);
    const double scale = 2097151.0 / std::max(widest(box), 1e-290);
    std::vector<std::pair<uint64_t, uint32_t>> keys(points.size());
    parallel_ranges(points.size(), kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const glm::dvec3 cell = (points[i] - box.min) * scale;
            keys[i] = {morton(static_cast<uint64_t>(cell.x), static_cast<uint64_t>(cell.y),
                              static_cast<uint64_t>(cell.z)),
                       static_cast<uint32_t>(i)};
        }
    });
    std::sort(keys.begin(), keys.end(), [&](const auto& a, const auto& b) {
        if (a.first != b.first) return a.first < b.first;
        const auto &p = points[a.second], &q = points[b.second];
        return p == q ? a.second < b.second : less(p, q);
    });
    order_.reserve(keys.size());
    sites_.reserve(keys.size());
    for (const auto& [key, i] : keys) {
        if (sites_.empty() || sites_.back() != points[i]) {
            first_.push_back(static_cast<uint32_t>(order_.size()));
            sites_.push_back(points[i]);
        }
        order_.push_back(i);
    }
    first_.push_back(static_cast<uint32_t>(order_.size()));
}

void ChunkNeighbours::find_around() {
    const ChunkAccess& chunks = cache_->chunks();
    for (size_t other = 0; other < chunks.chunk_count(); ++other) {
        if (other == chunk_ || chunks.point_count(other) == 0) continue;
        const Box bounds = chunks.bounds(other);
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

Result<void> ChunkNeighbours::search(std::span<const uint32_t> sites, size_t k, const Visit& visit) {
    assert(k <= kMostNeighbours);
    std::mutex mutex;
    std::vector<std::pair<uint32_t, double>> pending;  // site, radius to be known around it
    parallel_ranges(sites.size(), kGrain, [&](size_t first, size_t last) {
        std::array<Neighbour, kMostNeighbours> nearest;
        std::vector<std::pair<uint32_t, double>> out;
        SearchBound bound;
        for (const uint32_t site : sites.subspan(first, last - first)) {
            const size_t found = index_.merge_nearest(sites_[site], std::span(nearest).first(k), 0, 0,
                                                      bound.limit2(sites_[site]));
            const double reach2 = found == k ? nearest[k - 1].distance2 : kInfinity;
            bound = {sites_[site], std::sqrt(reach2)};
            if (reaches_out(site, reach2)) {
                out.emplace_back(site, std::sqrt(reach2));
                continue;
            }
            const double needed =
                visit(site, std::span(nearest).first(found), true, Surroundings(*this, site, 0.0));
            if (needed > 0) out.emplace_back(site, needed);
        }
        const std::lock_guard lock(mutex);
        pending.insert(pending.end(), out.begin(), out.end());
    });
    if (pending.empty()) return {};

    std::sort(pending.begin(), pending.end());
    std::vector<double> reaches;
    std::vector<uint32_t> pending_sites;
    for (const auto& [site, reach] : pending) {
        pending_sites.push_back(site);
        if (std::isfinite(reach)) reaches.push_back(reach);
    }
    double radius = widest(cache_->chunks().bounds(chunk_)) / 64;
    if (!reaches.empty()) {
        const auto median = reaches.begin() + static_cast<ptrdiff_t>(reaches.size() / 2);
        std::nth_element(reaches.begin(), median, reaches.end());
        radius = std::min(radius * 64 * kWidestHalo, *median);
    }
    return search_beyond(std::move(pending_sites), radius, k, visit);
}

Result<void> ChunkNeighbours::search_beyond(std::vector<uint32_t> pending, double radius, size_t k,
                                            const Visit& visit) {
    double widest_halo = kWidestHalo * widest(cache_->chunks().bounds(chunk_));
    for (int narrowed = 0; !pending.empty();) {
        LUCARNE_ASSIGN(const bool complete, load_halo(pending, radius));
        if (!complete &&
            narrowed < kMostNarrowings) {  // dense surroundings: what is near them is served by less
            widest_halo = radius /= 4;
            ++narrowed;
            continue;
        }
        const bool last_try = !complete || radius >= widest_halo;
        const auto halo_offset = static_cast<uint32_t>(sites_.size());
        std::mutex mutex;
        std::vector<uint32_t> still;
        double farthest = 0;
        parallel_ranges(pending.size(), kGrain / 8, [&](size_t first, size_t last) {
            std::array<Neighbour, kMostNeighbours> buffer;
            const auto nearest = std::span(buffer).first(k);
            for (const uint32_t site : std::span(pending).subspan(first, last - first)) {
                size_t found = index_.merge_nearest(sites_[site], nearest, 0, 0);
                found = halo_index_.merge_nearest(sites_[site], nearest, found, halo_offset);
                const double reach = found == k ? std::sqrt(nearest[k - 1].distance2) : kInfinity;
                const bool exact = complete && (reach <= radius || !reaches_out(site, reach * reach));
                double needed = reach;
                if (exact || last_try)
                    needed = visit(site, nearest.first(found), exact,
                                   Surroundings(*this, site, last_try ? kInfinity : radius));
                if (needed > 0) {
                    const std::lock_guard lock(mutex);
                    still.push_back(site);
                    farthest = std::max(farthest, needed);
                }
            }
        });
        std::sort(still.begin(), still.end());
        pending = std::move(still);
        // Four times as wide, or as wide as is certainly enough.
        radius = std::min({4 * radius, farthest, widest_halo});
    }
    return {};
}

bool ChunkNeighbours::Surroundings::knows(double radius) const {
    return radius <= halo || !of.reaches_out(site, radius * radius);
}

size_t ChunkNeighbours::Surroundings::nearest(double radius,
                                              const std::function<bool(const glm::vec3& offset)>& wanted,
                                              std::span<Neighbour> nearest) const {
    const glm::dvec3& at = of.sites_[site];
    const auto search = [&](const PointIndex& index, const std::vector<glm::dvec3>& points, size_t found,
                            size_t first) {
        return index.merge_nearest(at, nearest, found, static_cast<uint32_t>(first), radius * radius,
                                   [&](uint32_t i) { return wanted(glm::vec3(points[i] - at)); });
    };
    const size_t found = search(of.index_, of.sites_, 0, 0);
    return search(of.halo_index_, of.halo_, found, of.sites_.size());
}

void ChunkNeighbours::drop_indices() {
    index_ = PointIndex();
    halo_index_ = PointIndex();
    std::vector<glm::dvec3>().swap(halo_);
    std::vector<PointRef>().swap(halo_points_);
}

Result<bool> ChunkNeighbours::load_halo(std::span<const uint32_t> pending, double radius) {
    halo_index_ = PointIndex();
    halo_.clear();
    halo_points_.clear();
    std::vector<glm::dvec3> centres;
    for (const uint32_t site : pending) centres.push_back(sites_[site]);
    Box region = bounds_of(centres);
    region.min -= radius;
    region.max += radius;
    CellSet cells(region, radius);
    for (const auto& p : centres) cells.add_around(p);

    const size_t most = std::min<uint64_t>(std::max(kLeastHalo, kHaloShare * sites_.size()),
                                           std::max(kFewestHalo, halo_bytes_ / kHaloPointBytes));
    std::vector<std::pair<glm::dvec3, PointRef>> found;
    for (const Around& other : around_) {
        if (other.distance2 > radius * radius) break;
        std::vector<glm::dvec3> near;
        for (const auto& p : centres)
            if (distance2(p, other.bounds) <= radius * radius) near.push_back(p);
        if (near.empty()) continue;
        Box wanted = bounds_of(near);
        wanted.min -= radius;
        wanted.max += radius;
        LUCARNE_ASSIGN(const auto points, cache_->positions(other.chunk));
        for (size_t i = 0; i < points->size(); ++i) {
            const glm::dvec3& p = (*points)[i];
            if (distance2(p, wanted) > 0 || !cells.contains(p)) continue;
            if (found.size() == most) return false;
            found.emplace_back(p, PointRef{other.chunk, static_cast<uint32_t>(i)});
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return a.first == b.first ? a.second.index < b.second.index : less(a.first, b.first);
    });
    for (const auto& [p, ref] : found) {
        if (!halo_.empty() && halo_.back() == p) continue;
        halo_.push_back(p);
        halo_points_.push_back(ref);
    }
    halo_index_ = PointIndex(halo_);
    return true;
}

}  // namespace lucarne::octree
