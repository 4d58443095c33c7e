#include "octree/normals/chunk_cache.h"

#include <cmath>

#include "octree/normals/point_index.h"

namespace lucarne::octree {
namespace {

uint64_t bytes_of(const Positions& positions) {
    return positions->size() * sizeof(glm::dvec3);
}

bool searchable(const glm::dvec3& p) {
    constexpr double kMost = PointIndex::kLargestCoordinate;
    return std::abs(p.x) <= kMost && std::abs(p.y) <= kMost && std::abs(p.z) <= kMost;  // false for NaN, too
}

}  // namespace

Result<Positions> ChunkCache::positions(size_t chunk) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto at = found_.find(chunk); at != found_.end()) {
            entries_.splice(entries_.begin(), entries_, at->second);
            return at->second->positions;
        }
    }
    // Loaded without the lock: others go on meanwhile, at worst the same chunk is read twice.
    LUCARNE_ASSIGN(auto loaded, chunks_.positions(chunk));
    for (const auto& p : loaded)
        if (!searchable(p)) return rejected("normals", "a coordinate is larger than 1e150");
    auto positions = std::make_shared<const std::vector<glm::dvec3>>(std::move(loaded));

    const std::lock_guard lock(mutex_);
    if (found_.contains(chunk)) return positions;
    entries_.push_front({chunk, positions});
    found_[chunk] = entries_.begin();
    held_ += bytes_of(positions);
    while (held_ > limit_ && !entries_.empty()) {
        held_ -= bytes_of(entries_.back().positions);
        found_.erase(entries_.back().chunk);
        entries_.pop_back();
    }
    return positions;
}

}  // namespace lucarne::octree
