#include "gi/engines/paths/light_paths.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/lighting/area_points.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kLeavesAPiece = 64, kPathsAPiece = 1024;

/// Returns which of these sides lies at a share 0..1 of the area of all, in their order.
class ByArea {
 public:
    ByArea(std::span<const Surfel> surfels, std::span<const Side> sides) : sides_(sides) {
        for (const Side side : sides) {
            total_ += std::max(surfels[side / 2].area, 1e-12f);
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

EntryPoints choose_entries(std::span<const Surfel> surfels, const GroupBuilder& builder,
                           std::span<const float> areas, std::span<const uint8_t> used, uint64_t count) {
    EntryPoints entries;
    double total = 0;
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf)
        if (used[leaf]) total += areas[leaf];
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf) {
        entries.first.push_back(static_cast<uint32_t>(entries.sides.size()));
        if (!used[leaf]) continue;
        const std::span<const Side> sides = builder.sides_of(leaf);
        const ByArea places(surfels, sides);
        const double share = total > 0 ? areas[leaf] / total : 0, most = static_cast<double>(sides.size());
        const double own = std::clamp(std::round(share * static_cast<double>(count)), 1.0, most);
        for (double i = .5; i < own; ++i) entries.sides.push_back(places.at(i / own));
    }
    entries.first.push_back(static_cast<uint32_t>(entries.sides.size()));
    return entries;
}

void trace_links(const tracing::SurfelTracer& tracer, const GroupBuilder& builder, uint32_t first,
                 uint32_t last, uint64_t seed, std::span<RayHit> hits) {
    parallel_ranges(last - first, kLeavesAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const auto leaf = static_cast<uint32_t>(first + i);
            const ByArea starts(tracer.surfels(), builder.sides_of(leaf));
            Random random(seed, leaf);
            const double shift = random.uniform();
            for (uint32_t link = 0; link < kLinks; ++link) {
                // Places and directions are both even; a stride that is prime to kLinks makes them
                // independent.
                const Side side = starts.at(((link * 29) % kLinks + shift) / kLinks);
                const RayStart start = start_at(tracer.surfels(), side);
                float distance = 0;
                hits[i * kLinks + link] =
                    follow(tracer, start, cosine_direction(start.normal, even_point(link, seed, leaf)),
                           kLinks, distance);
            }
        }
    });
}

void trace_photons(const tracing::SurfelTracer& tracer, std::span<const uint32_t> leaf_of,
                   const EntryPoints& entries, size_t first, size_t last, uint64_t seed,
                   std::span<uint32_t> leaves) {
    parallel_ranges(last - first, kPathsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const size_t entry = first + i;
            Side side = entries.sides[entry];
            for (uint32_t vertex = 1; vertex < kVertices; ++vertex) {
                uint32_t& leaf = leaves[i * (kVertices - 1) + vertex - 1];
                leaf = kNone;
                if (side == kNone) continue;
                const RayStart start = start_at(tracer.surfels(), side);
                // Entry points stand beside each other in their order, so consecutive points are even
                // there as well.
                const glm::dvec2 at = even_point(static_cast<uint32_t>(entry), seed, vertex);
                float distance = 0;
                side = follow(tracer, start, cosine_direction(start.normal, at), 1, distance).side;
                if (side != kNone) leaf = leaf_of[side];
            }
        }
    });
}

}  // namespace lucarne::gi::paths
