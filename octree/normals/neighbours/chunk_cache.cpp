#include "octree/normals/neighbours/chunk_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

namespace lucarne::octree {
namespace {

uint64_t bytes_of(const Positions& positions) {
    return positions->size() * sizeof(glm::dvec3);
}

bool is_finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

constexpr int kExtentExponent = 50;       ///< a float can hold the sum of millions of squares of 2^50
constexpr int kMostScaleExponent = 1000;  ///< keeps the scale and its inverse normal doubles

double scale_of(const ChunkAccess& chunks) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Box all{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (size_t chunk = 0; chunk < chunks.chunk_count(); ++chunk) {
        if (chunks.point_count(chunk) == 0) continue;
        const Box box = chunks.bounds(chunk);
        all.min = glm::min(all.min, box.min);
        all.max = glm::max(all.max, box.max);
    }
    const glm::dvec3 extent = all.max - all.min;
    const double widest =
        std::min(std::max({extent.x, extent.y, extent.z}), std::numeric_limits<double>::max());
    if (!(widest > 0)) return 1;  // no points, or all in one place
    return std::ldexp(
        1.0, std::clamp(kExtentExponent - std::ilogb(widest), -kMostScaleExponent, kMostScaleExponent));
}

}  // namespace

ChunkCache::ChunkCache(const ChunkAccess& chunks, uint64_t bytes)
    : chunks_(chunks), limit_(bytes), scale_(scale_of(chunks)) {}

Box ChunkCache::bounds(size_t chunk) const {
    const Box box = chunks_.bounds(chunk);
    return {box.min * scale_, box.max * scale_};
}

Result<Positions> ChunkCache::scaled(std::vector<glm::dvec3> positions) const {
    for (auto& p : positions) {
        p *= scale_;
        if (!is_finite(p)) return rejected("normals", "a coordinate is not a finite number");
    }
    return std::make_shared<const std::vector<glm::dvec3>>(std::move(positions));
}

Result<ChunkCache::Near> ChunkCache::near(size_t chunk, const Box& box) {
    Near near;
    LUCARNE_ASSIGN(auto far, chunks_.far_points(chunk, {box.min / scale_, box.max / scale_}));
    if (far) {
        near.indices = std::move(far->indices);
        LUCARNE_ASSIGN(near.positions, scaled(std::move(far->positions)));
    } else {
        LUCARNE_ASSIGN(near.positions, positions(chunk));
    }
    return near;
}

Result<Positions> ChunkCache::positions(size_t chunk) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto at = found_.find(chunk); at != found_.end()) {
            entries_.splice(entries_.begin(), entries_, at->second);
            return at->second->positions;
        }
    }
    // Loads without the lock, so that other threads continue. At worst, the same chunk is read twice.
    LUCARNE_ASSIGN(auto loaded, chunks_.positions(chunk));
    LUCARNE_ASSIGN(auto positions, scaled(std::move(loaded)));

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
