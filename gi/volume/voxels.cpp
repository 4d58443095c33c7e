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

#include "gi/shared/surfel_code.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"
#include "gi/volume/disc_shares.h"
#include "gi/volume/native/discs.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kSurfelsAPiece = 16384, kSurfelsAtOnce = 8 * kSurfelsAPiece;
/// How many parts there may be, of 12 bytes each while they are made: some, and so many a surfel. A disc of a
/// scan touches two voxels on the average.
constexpr size_t kSomeParts = size_t{1} << 22, kPartsASurfel = 8;
constexpr size_t kGapsATask = 256;

/// Returns the blocks of a cell in a box, which is in units of voxels.
uint64_t block_box(const glm::ivec3& cell, const glm::vec3& low, const glm::vec3& high) {
    constexpr auto kPerVoxel = static_cast<float>(kBlocksAlong);
    const glm::vec3 corner(cell);
    return blocks_in_box(kPerVoxel * (low - corner), kPerVoxel * (high - corner));
}

glm::vec3 vector_of(const std::array<DiscBatch::Floats, 3>& components, size_t disc) {
    return {components[0][disc], components[1][disc], components[2][disc]};
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

/// Marks the blocks of a cell that a disc touches. Most are marked already, by the discs about it. `box`: of
/// the disc's part in the cell (blocks beyond it, which an octagon may touch, do not count).
void VoxelMaker::mark(const DiscBatch& discs, size_t disc, const glm::ivec3& cell, uint64_t box) {
    const uint32_t number = grid_.number(cell);
    const int own_gap = discs.gap[disc];
    const std::atomic_ref<uint8_t> gap(gaps_[number]);
    uint8_t widest = gap.load(std::memory_order_relaxed);
    while (widest < own_gap &&
           !gap.compare_exchange_weak(widest, static_cast<uint8_t>(own_gap), std::memory_order_relaxed)) {
    }
    const std::atomic_ref<uint64_t> marked(blocks_[number]);
    const uint64_t missing = ~marked.load(std::memory_order_relaxed);
    if (own_gap > kWidestGap) {
        if (missing != 0) marked.fetch_or(kAllBlocks, std::memory_order_relaxed);
        return;
    }
    if ((missing & box) == 0) return;
    constexpr auto kPerVoxel = static_cast<float>(kBlocksAlong);
    const uint64_t found =
        blocks_touched(missing & box, kPerVoxel * (vector_of(discs.place, disc) - glm::vec3(cell)),
                       vector_of(discs.normal, disc), kPerVoxel * discs.radius[disc]);
    if (found != 0) marked.fetch_or(found, std::memory_order_relaxed);
}

void VoxelMaker::add_parts(const DiscBatch& discs, size_t disc, uint32_t number,
                           std::vector<CellPart>& target) {
    const glm::vec3 place = vector_of(discs.place, disc);
    const float reach = 1.5f * discs.radius[disc] + kTouching;  // of the octagon's corners, and some more
    const glm::vec3 size(grid_.size);
    const bool inside =
        glm::all(glm::greaterThan(place, glm::vec3(reach))) && glm::all(glm::lessThan(place, size - reach));
    if (!inside && (glm::any(glm::lessThan(place, glm::vec3(-reach))) ||
                    glm::any(glm::greaterThan(place, size + reach))))
        return;
    const float whole = discs.area[disc];
    // Most discs lie in a few voxels.
    std::array<DiscPart, 4> parts;
    if (const size_t few = inside ? few_parts(discs, disc, parts) : 0) {
        for (size_t i = 0; i < few; ++i) {
            target.push_back({grid_.number(parts[i].cell), {number, whole * parts[i].share}});
            mark(discs, disc, parts[i].cell, parts[i].box);
        }
        return;
    }
    const FlatSurfel& surfel = surfels_[number];
    const glm::vec3 middle(surfel.x, surfel.y, surfel.z), normal = vector_of(discs.normal, disc);
    const float radius = discs.radius[disc] * grid_.voxel;
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
        mark(discs, disc, cell, block_box(cell, least, most));
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
        DiscBatch discs;
        for (size_t i = done_ + first; i < done_ + last && parts_.load(std::memory_order_relaxed) <= most_;
             i += DiscBatch::kMost) {
            const auto batch = surfels_.subspan(i, std::min(DiscBatch::kMost, done_ + last - i));
            prepare_discs(batch, grid_, discs);
            for (size_t k = 0; k < batch.size(); ++k) {
                if (!has_disc(batch[k])) continue;
                add_parts(discs, k, static_cast<uint32_t>(i + k), own);
                if (own.size() - counted < kSurfelsAPiece) continue;
                parts_ += own.size() - counted;
                counted = own.size();
                if (parts_.load(std::memory_order_relaxed) > most_) break;
            }
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
