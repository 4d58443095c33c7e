#include "gi/engines/paths/light_paths.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <glm/common.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/lighting/area_points.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kOriginsAtOnce = 2048, kOriginsAPiece = 16, kPathsAPiece = 1024;

/// Returns which of these sides lies at a share 0..1 of the area of all, in their order.
class ByArea {
 public:
    ByArea(const Surfaces& surfaces, std::span<const Side> sides) : sides_(sides) {
        for (const Side side : sides) {
            total_ += std::max(surfaces.area_of(side), 1e-12f);
            ends_.push_back(total_);
        }
    }
    Side at(double share) const {
        const auto found = std::ranges::upper_bound(ends_, share * total_);
        return sides_[std::min(static_cast<size_t>(found - ends_.begin()), sides_.size() - 1)];
    }

 private:
    std::span<const Side> sides_;
    std::vector<double> ends_;
    double total_ = 0;
};

}  // namespace

EntryPoints choose_entries(const Surfaces& surfaces, const GroupBuilder& builder,
                           std::span<const float> areas, std::span<const uint8_t> used,
                           std::span<const RayHit> hits, uint64_t count) {
    EntryPoints entries;
    const std::span<const uint32_t> leaf_of = builder.leaf_of();
    double total = 0;
    std::vector<uint32_t> met(builder.leaves(), 0);
    for (const RayHit& hit : hits)
        if (hit.side != kNone) ++met[leaf_of[hit.side]];
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf)
        if (used[leaf]) total += areas[leaf];
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf) {
        entries.first.push_back(static_cast<uint32_t>(entries.sides.size()));
        if (!used[leaf]) continue;
        const std::span<const Side> sides = builder.sides_of(leaf);
        const double share = total > 0 ? areas[leaf] / total : 0, most = static_cast<double>(sides.size());
        const auto own =
            static_cast<uint32_t>(std::clamp(std::round(share * static_cast<double>(count)), 1.0, most));
        if (met[leaf] > 0) {
            entries.sides.insert(entries.sides.end(), std::min(own, met[leaf]), kNone);
            continue;
        }
        const ByArea places(surfaces, sides);
        for (uint32_t i = 0; i < own; ++i) entries.sides.push_back(places.at((i + .5) / own));
    }
    entries.first.push_back(static_cast<uint32_t>(entries.sides.size()));
    // Every so many of the hits of a leaf, in their order.
    std::vector<uint32_t> gone(builder.leaves(), 0);
    for (const RayHit& hit : hits) {
        if (hit.side == kNone || !used[leaf_of[hit.side]]) continue;
        const uint32_t leaf = leaf_of[hit.side], first = entries.first[leaf];
        const uint64_t own = entries.first[leaf + 1] - first, number = gone[leaf]++;
        const uint64_t place = (2 * number + 1) * own / (2 * uint64_t{met[leaf]});
        if ((2 * number + 1) * own % (2 * uint64_t{met[leaf]}) < 2 * own)
            entries.sides[first + place] = hit.side;
    }
    return entries;
}

LinkBuilder::LinkBuilder(const Surfaces& surfaces, const GroupBuilder& builder, const Groups& groups,
                         float reach, uint64_t seed)
    : surfaces_(surfaces),
      builder_(builder),
      groups_(groups),
      reach_(reach),
      seed_(seed),
      asked_(groups.count(), 0),
      used_(groups.leaves, 0),
      number_of_(groups.count(), kNone) {
    links_.origin_of.assign(groups.leaves, kNone);
}

void LinkBuilder::ask(uint32_t group) {
    std::vector<uint32_t> open = {group};
    while (!open.empty()) {
        const uint32_t asked = open.back();
        open.pop_back();
        if (std::exchange(asked_[asked], 1)) continue;
        if (asked >= groups_.leaves) {
            const auto children = groups_.children_of(asked);
            open.insert(open.end(), children.begin(), children.end());
            continue;
        }
        used_[asked] = 1;
        const uint32_t origin = groups_.fitting(asked, reach_);
        if (number_of_[origin] == kNone) {
            number_of_[origin] = static_cast<uint32_t>(origins_.size());
            origins_.push_back(origin);
        }
        links_.origin_of[asked] = number_of_[origin];
    }
}

std::vector<Side> LinkBuilder::sides_of(uint32_t group) const {
    std::vector<Side> sides;
    std::vector<uint32_t> open = {group};
    while (!open.empty()) {
        const uint32_t part = open.back();
        open.pop_back();
        if (part < groups_.leaves) {
            const auto own = builder_.sides_of(part);
            sides.insert(sides.end(), own.begin(), own.end());
        } else {
            const auto children = groups_.children_of(part);
            open.insert(open.end(), children.begin(), children.end());
        }
    }
    return sides;
}

double LinkBuilder::share() const {
    return origins_.empty() ? 1 : static_cast<double>(next_) / static_cast<double>(origins_.size());
}

bool LinkBuilder::advance() {
    const size_t first = next_, last = std::min(origins_.size(), first + kOriginsAtOnce);
    links_.groups.resize(last * kLinks, kNone);
    std::vector<uint32_t> directions((last - first) * kLinks);
    parallel_ranges(last - first, kOriginsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = first + begin; i < first + end; ++i) {
            const uint32_t origin = origins_[i];
            const std::vector<Side> sides = sides_of(origin);
            const ByArea starts(surfaces_, sides);
            const double shift = Random(seed_, origin).uniform();
            for (uint32_t link = 0; link < kLinks; ++link) {
                // Places and directions are both even; a stride that is prime to kLinks makes them
                // independent.
                const Side side = starts.at(((link * 29) % kLinks + shift) / kLinks);
                const RayStart start = start_at(surfaces_.surfels(), side);
                const glm::dvec2 at = even_point(link, seed_, origin);
                float distance = 0;
                const glm::vec3 direction = cosine_direction(start.normal, at);
                directions[(i - first) * kLinks + link] = encode_octahedral(direction);
                const RayHit hit = follow(surfaces_, start, direction, kLinks, distance);
                if (hit.side != kNone)
                    links_.groups[i * kLinks + link] = groups_.fitting(groups_.leaf_of[hit.side], hit.width);
            }
        }
    });
    next_ = last;
    for (size_t origin = first; origin < last; ++origin) {
        for (size_t i = origin * kLinks; i < (origin + 1) * kLinks; ++i) {
            if (links_.groups[i] != kNone)
                ask(links_.groups[i]);
            else
                links_.open.push_back(directions[i - first * kLinks]);
        }
        links_.first_open.push_back(static_cast<uint32_t>(links_.open.size()));
    }
    // Only their sum counts, and sorted numbers take less room in a file.
    parallel_ranges(last - first, kOriginsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = first + begin; i < first + end; ++i)
            std::ranges::sort(std::span(links_.groups).subspan(i * kLinks, kLinks));
    });
    return next_ < origins_.size();
}

void trace_photons(const Surfaces& surfaces, std::span<const uint32_t> leaf_of, const EntryPoints& entries,
                   size_t first, size_t last, uint64_t seed, std::span<uint32_t> leaves) {
    parallel_ranges(last - first, kPathsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const size_t entry = first + i;
            Side side = entries.sides[entry];
            for (uint32_t vertex = 1; vertex < kVertices; ++vertex) {
                uint32_t& leaf = leaves[i * (kVertices - 1) + vertex - 1];
                leaf = kNone;
                if (side == kNone) continue;
                const RayStart start = start_at(surfaces.surfels(), side);
                // Entry points stand beside each other in their order, so consecutive points are even
                // there as well.
                const glm::dvec2 at = even_point(static_cast<uint32_t>(entry), seed, vertex);
                float distance = 0;
                side = follow(surfaces, start, cosine_direction(start.normal, at), 1, distance).side;
                if (side != kNone) leaf = leaf_of[side];
            }
        }
    });
}

}  // namespace lucarne::gi::paths
