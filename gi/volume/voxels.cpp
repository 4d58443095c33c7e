#include "gi/volume/voxels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vector_relational.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/surfel_code.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"
#include "gi/volume/disc_shares.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kSurfelsAPiece = 16384, kSurfelsAtOnce = 8 * kSurfelsAPiece;
/// How many parts there may be, of 12 bytes each while they are made: some, and so many a surfel. A disc of a
/// scan touches two voxels on the average.
constexpr size_t kSomeParts = size_t{1} << 22, kPartsASurfel = 8;
/// Of a disc, in voxels: those of a broken file would touch every voxel of the grid, one after the other.
constexpr float kLargestRadius = 1024;
constexpr size_t kGapsATask = 256;

/// Returns the part of a polygon in a box.
Polygon clipped(Polygon polygon, const glm::vec3& low, const glm::vec3& high) {
    for (int axis = 0; axis < 3; ++axis)
        polygon = cut(cut(polygon, axis, 1.0f, low[axis]), axis, -1.0f, -high[axis]);
    return polygon;
}

}  // namespace

bool has_disc(const FlatSurfel& surfel) {
    return surfel.radius > 0 && std::isfinite(surfel.radius) && std::isfinite(surfel.x) &&
           std::isfinite(surfel.y) && std::isfinite(surfel.z) && (surfel.albedo & kSurfelHasNormal) != 0;
}

Grid grid_about(std::span<const FlatSurfel> surfels, uint32_t longest) {
    using Box = std::pair<glm::vec3, glm::vec3>;
    const glm::vec3 none(std::numeric_limits<float>::infinity());
    std::vector<Box> boxes((surfels.size() + kSurfelsAPiece - 1) / kSurfelsAPiece, {none, -none});
    parallel_ranges(surfels.size(), kSurfelsAPiece, [&](size_t first, size_t last) {
        auto& [low, high] = boxes[first / kSurfelsAPiece];
        for (size_t i = first; i < last; ++i) {
            if (!has_disc(surfels[i])) continue;
            const glm::vec3 middle(surfels[i].x, surfels[i].y, surfels[i].z);
            low = glm::min(low, middle);
            high = glm::max(high, middle);
        }
    });
    glm::vec3 low = none, high = -none;
    for (const auto& [least, most] : boxes) {
        low = glm::min(low, least);
        high = glm::max(high, most);
    }
    return low.x <= high.x ? grid_about(low, high, longest) : Grid{};
}

VoxelMaker::VoxelMaker(std::span<const FlatSurfel> surfels, const Grid& grid)
    : surfels_(surfels),
      grid_(grid),
      pieces_((surfels.size() + kSurfelsAPiece - 1) / kSurfelsAPiece),
      blocks_(grid.cells(), 0),
      gaps_(grid.cells(), 0),
      most_(kSomeParts + kPartsASurfel * surfels.size()) {}

/// Marks the blocks of a cell that a part of a disc touches. Most are marked already, by the discs about it:
/// only where blocks near the part are missing does it ask for the polygon of the part. `low`, `high`: of the
/// part, in units of voxels.
template <class Part>
void VoxelMaker::mark(const Disc& disc, const glm::ivec3& cell, const glm::vec3& low, const glm::vec3& high,
                      const Part& part) {
    const uint32_t number = grid_.number(cell);
    const std::atomic_ref<uint8_t> gap(gaps_[number]);
    uint8_t widest = gap.load(std::memory_order_relaxed);
    while (widest < disc.gap && !gap.compare_exchange_weak(widest, disc.gap, std::memory_order_relaxed)) {
    }
    const std::atomic_ref<uint64_t> marked(blocks_[number]);
    const glm::vec3 corner(cell);
    constexpr auto kPerVoxel = static_cast<float>(kBlocksAlong);
    const uint64_t missing = ~marked.load(std::memory_order_relaxed);
    if (disc.gap > kWidestGap) {
        if (missing != 0) marked.fetch_or(kAllBlocks, std::memory_order_relaxed);
        return;
    }
    // Blocks beyond the box, which an octagon may touch, do not count: whether they are asked for depends on
    // which disc comes first.
    const uint64_t box = blocks_in_box(kPerVoxel * (low - corner), kPerVoxel * (high - corner));
    if (blocks_near_plane(missing & box, disc.normal, kPerVoxel * (disc.place - corner)) == 0) return;
    marked.fetch_or(box & blocks_of(part(), cell), std::memory_order_relaxed);
}

void VoxelMaker::add_parts(uint32_t number, std::vector<CellPart>& target) {
    const FlatSurfel& surfel = surfels_[number];
    const float radius = std::min(surfel.radius, kLargestRadius * grid_.voxel);
    const glm::vec3 middle(surfel.x, surfel.y, surfel.z), place = grid_.place(middle);
    const float reach = 1.5f * radius / grid_.voxel + kTouching;  // of the octagon's corners, and some more
    const glm::vec3 size(grid_.size);
    const bool inside =
        glm::all(glm::greaterThan(place, glm::vec3(reach))) && glm::all(glm::lessThan(place, size - reach));
    if (!inside && (glm::any(glm::lessThan(place, glm::vec3(-reach))) ||
                    glm::any(glm::greaterThan(place, size + reach))))
        return;
    const glm::vec3 normal = decode_octahedral(surfel.normal);
    const float whole = surfel.area > 0 ? surfel.area : kPi * radius * radius;
    const Disc disc{
        place, normal,
        static_cast<uint8_t>(gap_between(radius / grid_.voxel, whole / (grid_.voxel * grid_.voxel)))};
    // Most discs lie in a few voxels.
    std::array<DiscPart, 4> parts;
    if (const size_t few = inside ? few_parts(place, normal, radius / grid_.voxel, parts) : 0) {
        for (size_t i = 0; i < few; ++i) {
            const DiscPart& part = parts[i];
            target.push_back({grid_.number(part.cell), {number, whole * part.share}});
            mark(disc, part.cell, part.low, part.high, [&] {
                return clipped(octagon_about(grid_, middle, normal, radius), glm::vec3(part.cell) - kTouching,
                               glm::vec3(part.cell + 1) + kTouching);
            });
        }
        return;
    }
    const size_t first = target.size();
    float sum = 0;
    for_each_voxel(grid_, middle, normal, radius, [&](const glm::ivec3& cell, const Polygon& part) {
        const float area = part.area();
        sum += area;
        target.push_back({grid_.number(cell), {number, area}});
        glm::vec3 least = part.corners[0], most = least;
        for (size_t i = 1; i < part.count; ++i) {
            least = glm::min(least, part.corners[i]);
            most = glm::max(most, part.corners[i]);
        }
        mark(disc, cell, least, most, [&] { return part; });
    });
    if (grid_.part && !inside) sum = std::max(sum, octagon_about(grid_, middle, normal, radius).area());
    for (size_t i = first; i < target.size(); ++i)
        target[i].part.area =
            sum > 0 ? target[i].part.area / sum * whole : whole / static_cast<float>(target.size() - first);
}

Result<bool> VoxelMaker::advance() {
    const size_t end = std::min(surfels_.size(), done_ + kSurfelsAtOnce);
    parallel_ranges(end - done_, kSurfelsAPiece, [&](size_t first, size_t last) {
        auto& own = pieces_[(done_ + first) / kSurfelsAPiece];
        own.reserve(2 * (last - first));
        size_t counted = 0;
        for (size_t i = done_ + first; i < done_ + last && parts_.load(std::memory_order_relaxed) <= most_;
             ++i) {
            if (!has_disc(surfels_[i])) continue;
            add_parts(static_cast<uint32_t>(i), own);
            if (own.size() - counted < kSurfelsAPiece) continue;
            parts_ += own.size() - counted;
            counted = own.size();
        }
        parts_ += own.size() - counted;
    });
    done_ = end;
    if (parts_ > most_)
        return failed("volume", fmt::format("the surfels' discs touch voxels more than {} times", most_),
                      "choose fewer voxels (--voxels) or more points");
    return done_ < surfels_.size();
}

Voxels VoxelMaker::finish() {
    Voxels voxels;
    voxels.grid_ = grid_;
    voxels.numbers_.assign(grid_.cells(), Voxels::kAir);
    // Surfels of a voxel stay in their order, because pieces and their parts are taken in theirs.
    std::vector<uint32_t> counts(grid_.cells(), 0);
    for (const auto& piece : pieces_)
        for (const CellPart& part : piece) ++counts[part.cell];
    voxels.starts_.push_back(0);
    for (uint32_t cell = 0; cell < counts.size(); ++cell) {
        if (counts[cell] == 0) continue;
        voxels.numbers_[cell] = static_cast<uint32_t>(voxels.occupied_.size());
        voxels.occupied_.push_back(cell);
        voxels.starts_.push_back(voxels.starts_.back() + counts[cell]);
    }
    voxels.parts_.resize(voxels.starts_.back());
    std::vector<uint8_t> gaps;
    for (const uint32_t cell : voxels.occupied_) {
        voxels.blocks_.push_back(blocks_[cell]);
        gaps.push_back(gaps_[cell]);
    }
    std::vector<size_t> next(voxels.starts_.begin(), voxels.starts_.end() - 1);
    for (auto& piece : pieces_) {
        for (const CellPart& part : piece) {
            const uint32_t voxel = voxels.numbers_[part.cell];
            voxels.parts_[next[voxel]++] = part.part;
        }
        piece = {};
    }
    voxels.close_gaps(gaps);
    return voxels;
}

/// Adds blocks that lie in gaps between discs. `gaps`: by occupied voxel, of its largest disc.
void Voxels::close_gaps(std::span<const uint8_t> gaps) {
    std::vector<uint64_t> closed(blocks_.size());
    parallel_ranges(closed.size(), kGapsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            closed[i] = blocks_[i] == kAllBlocks
                            ? kAllBlocks
                            : without_gaps(blocks_about(static_cast<uint32_t>(i)), gaps[i]);
    });
    blocks_ = std::move(closed);
}

std::array<uint64_t, 27> Voxels::blocks_about(uint32_t voxel) const {
    std::array<uint64_t, 27> found;
    const glm::ivec3 cell = grid_.cell(occupied_[voxel]);
    for (int i = 0; i < 27; ++i) {
        const glm::ivec3 other = cell + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
        const uint32_t number = at(other);
        found[static_cast<size_t>(i)] = number != kAir ? blocks_[number] : is_air(other) ? 0 : kAllBlocks;
    }
    return found;
}

Result<Voxels> Voxels::divide(std::span<const FlatSurfel> surfels, const Grid& grid) {
    VoxelMaker maker(surfels, grid);
    for (bool more = true; more;) {
        LUCARNE_ASSIGN(more, maker.advance());
    }
    return maker.finish();
}

}  // namespace lucarne::gi::volume
