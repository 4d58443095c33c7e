#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "octree/normals/neighbours/neighbours.h"

namespace lucarne::octree {
namespace {

/// Most points gathered for a group and for one site. Where a group's surroundings hold more (a group of
/// distant outliers has the whole cloud around it), its sites are handled one at a time.
constexpr size_t kMostShared = 4096, kMostAlone = 16384;
/// How much wider than requested points are gathered, because the next site will request a little more.
constexpr double kSlack = 1.1;
/// In a tile of a given size, floats distinguish neighbours at this share of the size well, but not much
/// nearer ones.
constexpr double kFinest = 1.0 / 4096;
constexpr double kMoreThanRounding = 1 + 1e-5;

float square(double v) {
    return static_cast<float>(v * v);
}

}  // namespace

bool ChunkNeighbours::Surroundings::gather(const Box& box, double radius, size_t most,
                                           Gathered& gathered) const {
    if (radius >= gathered.crowded) return false;
    Tile& tile = gathered.tile;
    tile.clear((box.min + box.max) * 0.5);
    gathered.radius = -1;
    const auto halo = static_cast<uint32_t>(of_.sites_.size());
    if (!of_.index_->gather(box, radius, 0, most, tile) ||
        (of_.halo_index_ && !of_.halo_index_->gather(box, radius, halo, most, tile))) {
        gathered.crowded = radius;
        return false;
    }
    tile.pad();
    gathered.radius = radius;
    gathered.all = tile.count == of_.sites_.size() + of_.halo_.size();
    return true;
}

void ChunkNeighbours::Surroundings::begin(std::span<const uint32_t> sites, size_t k) {
    box_ = {of_.sites_[sites.front()], of_.sites_[sites.front()]};
    for (const uint32_t site : sites) {
        box_.min = glm::min(box_.min, of_.sites_[site]);
        box_.max = glm::max(box_.max, of_.sites_[site]);
    }
    // The reach of the previous group, or the one that follows from the spacing of this group's sites, if
    // less.
    const double size = glm::distance(box_.min, box_.max),
                 own = size * std::sqrt(static_cast<double>(k) / static_cast<double>(sites.size()));
    guess_ = farthest_ > 0 ? farthest_ * kSlack : kInfinity;
    if (own > 0) guess_ = std::min(guess_, own);
    if (!std::isfinite(guess_)) guess_ = glm::distance(of_.box_.min, of_.box_.max) / 64;
    farthest_ = 0;
    near_.clear();
    wide_.clear();
}

const Patch& ChunkNeighbours::Surroundings::visit(uint32_t site, size_t k) {
    site_ = site;
    alone_ = of_.search_ != NeighbourSearch::leaf || !find_shared(k);
    if (alone_) nearest(k, nearest_);
    previous_ = of_.sites_[site];
    previous_reach_ = nearest_.count == k ? std::sqrt(double{nearest_.distance2[k - 1]}) : -1;
    farthest_ = std::max(farthest_, previous_reach_);
    return nearest_;
}

/// Finds the k nearest among the points gathered around the whole group. Returns false where they do not
/// suffice.
bool ChunkNeighbours::Surroundings::find_shared(size_t k) {
    constexpr int kMostTries = 12;
    const glm::dvec3 at = of_.sites_[site_];
    // An upper bound: the distance to the previous site plus that of the previous site's k-th nearest.
    const double bound = previous_reach_ >= 0
                             ? (glm::distance(at, previous_) + previous_reach_) * kMoreThanRounding
                             : kInfinity;
    for (int tries = 0;; ++tries) {
        if (near_.radius < guess_ && !near_.all && !gather(box_, guess_, kMostShared, near_)) return false;
        const glm::vec3 centre(at - near_.tile.origin);
        const double known = near_.all ? kInfinity : near_.radius;
        candidates_.take_within(near_.tile, centre, square(std::min(bound, known)));
        if (candidates_.count < k && bound < known)
            candidates_.take_within(near_.tile, centre, square(known));
        if (candidates_.count >= k || near_.all) break;
        const double lack =
            static_cast<double>(k) / static_cast<double>(std::max<size_t>(1, candidates_.count));
        guess_ = near_.radius * std::clamp(kSlack * std::sqrt(lack), 1.25, 4.0);
        if (!(guess_ > near_.radius) || tries == kMostTries) return false;
    }
    nearest_.take_nearest(candidates_, k);
    if (nearest_.count < 2) return false;
    const double reach = std::sqrt(double{nearest_.distance2[nearest_.count - 1]});
    return reach > kFinest * (std::min(near_.radius, 1e300) + glm::distance(box_.min, box_.max));
}

/// Finds the k nearest, where k is more than visit() asked for, in ever wider surroundings of the whole
/// group.
bool ChunkNeighbours::Surroundings::find_wide(size_t k, Patch& patch) {
    constexpr int kMostTries = 4;
    double radius = previous_reach_;
    for (int tries = 0; !alone_ && radius > 0 && tries < kMostTries; ++tries) {
        radius *= 2;
        if (within(radius, candidates_) < radius) return false;
        if (candidates_.count < k) continue;
        patch.take_nearest(candidates_, k);
        return true;
    }
    return false;
}

void ChunkNeighbours::Surroundings::nearest(size_t k, Patch& patch) {
    if (find_wide(k, patch)) return;
    std::vector<Neighbour> found(k);
    size_t count = of_.index_->merge_nearest(of_.sites_[site_], found, 0, 0);
    if (of_.halo_index_)
        count = of_.halo_index_->merge_nearest(of_.sites_[site_], found, count,
                                               static_cast<uint32_t>(of_.sites_.size()));
    patch.clear();
    patch.make_room(count);
    for (size_t i = 0; i < count; ++i)
        patch.push_back(glm::vec3(of_.position(found[i].index) - of_.sites_[site_]), found[i].index);
    patch.pad();
}

bool ChunkNeighbours::Surroundings::knows(double radius) const {
    return radius <= halo_ || !of_.reaches_out(site_, radius * radius);
}

bool ChunkNeighbours::Surroundings::surely_knows(double radius) const {
    return radius <= certain_ || !of_.reaches_out(site_, radius * radius);
}

ChunkNeighbours::Surroundings::View ChunkNeighbours::Surroundings::around(double radius) {
    const glm::dvec3 at = of_.sites_[site_];
    const auto view = [&](const Gathered& gathered) {
        return View{gathered.tile, glm::vec3(at - gathered.tile.origin), radius};
    };
    if (!alone_ && (near_.radius >= radius || near_.all)) return view(near_);
    if (!alone_ && (wide_.radius >= radius || gather(box_, radius * kSlack, kMostShared, wide_)))
        return view(wide_);
    own_.clear();
    while (!gather({at, at}, radius, kMostAlone, own_) && radius > 0) radius /= 2;
    return view(own_);
}

double ChunkNeighbours::Surroundings::within(double radius, Patch& patch) {
    const View view = around(radius);
    patch.take_within(view.tile, view.centre, square(view.radius));
    return view.radius;
}

}  // namespace lucarne::octree
