#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "gi/shared/flat_surfel.h"
#include "gi/volume/grid.h"

namespace lucarne::gi::volume {

/// Of a disc, in voxels: those of a broken file would touch every voxel of the grid, one after the other.
inline constexpr float kLargestRadius = 1024;

/// What the division of some discs among voxels starts with, by axis and disc. Lengths are in voxels.
struct DiscBatch {
    static constexpr size_t kMost = 16;  ///< discs
    using Floats = std::array<float, kMost>;
    using Ints = std::array<int32_t, kMost>;

    alignas(64) std::array<Floats, 3> place;    ///< of the middle
    alignas(64) std::array<Floats, 3> normal;   ///< unit
    alignas(64) std::array<Floats, 3> across;   ///< how far a disc of radius 1 reaches
    alignas(64) Floats radius;                  ///< at most kLargestRadius
    alignas(64) Floats area;                    ///< of its share of the surface, m^2
    alignas(64) Ints gap;                       ///< gap_between() of discs like this
    alignas(64) std::array<Ints, 3> first;      ///< cell that it touches
    alignas(64) std::array<Ints, 3> last;       ///< likewise
    alignas(64) std::array<Ints, 3> low_block;  ///< the first block that it touches, from the first cell on
    alignas(64) std::array<Ints, 3> high_block;
    alignas(64) std::array<Floats, 3> distance;  ///< from the middle to where the last cell begins, in the
                                                 ///< disc's plane, radii
    alignas(64) std::array<Floats, 3> below;     ///< share of the disc before that
};

/// Sets `batch` to up to kMost discs. Cells and blocks mean something only for discs that lie in the grid as
/// a whole; nothing does for those without a disc.
void prepare_discs(std::span<const FlatSurfel> surfels, const Grid& grid, DiscBatch& batch);

}  // namespace lucarne::gi::volume
