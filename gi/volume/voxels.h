#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/shared/flat_surfel.h"
#include "gi/volume/grid.h"
#include "io/core/error.h"

namespace lucarne::gi::volume {

struct DiscBatch;

/// A part of a surfel in a voxel.
struct SurfelPart {
    uint32_t surfel = 0;
    float area = 0;  ///< of the surfel's share of the surface, m^2
};

/// The surfels of each voxel. A surfel's area is shared out over all voxels that its disc touches, in
/// proportion to the part of the disc inside them; so the areas of a surfel's parts add up to its own, or to
/// as much of it as a grid holds that is part of a larger space.
class Voxels {
 public:
    static constexpr uint32_t kAir = 0xffffffffu;

    /// Divides those surfels that have a disc: a normal, a radius over zero, and a place in the grid. The
    /// result is the same whatever the number of threads. Errors: discs that together touch too many voxels.
    static Result<Voxels> divide(std::span<const FlatSurfel> surfels, const Grid& grid);

    const Grid& grid() const { return grid_; }
    /// The cells of the occupied voxels, sorted by number. Occupied voxels are counted in this order.
    std::span<const uint32_t> occupied() const { return occupied_; }
    /// Returns the occupied voxel at a cell; kAir if nothing is there, or beyond the grid.
    uint32_t at(const glm::ivec3& cell) const {
        return grid_.holds(cell) ? numbers_[grid_.number(cell)] : kAir;
    }
    /// Beyond a grid that is part of a larger space nothing is known to be air.
    bool is_air(const glm::ivec3& cell) const {
        return grid_.holds(cell) ? numbers_[grid_.number(cell)] == kAir : !grid_.part;
    }
    /// By cell: the occupied voxel, or kAir.
    std::span<const uint32_t> numbers() const { return numbers_; }
    /// The parts of surfels in an occupied voxel, sorted by surfel.
    std::span<const SurfelPart> parts(uint32_t voxel) const {
        return std::span(parts_).subspan(starts_[voxel], starts_[voxel + 1] - starts_[voxel]);
    }
    size_t all_parts() const { return parts_.size(); }
    /// The blocks of an occupied voxel that discs touch, and those in gaps between discs (blocks.h).
    uint64_t blocks(uint32_t voxel) const { return blocks_[voxel]; }
    /// Those of the 3 x 3 x 3 voxels about an occupied one, x fastest: none of air, and all where nothing is
    /// known.
    std::array<uint64_t, 27> blocks_about(uint32_t voxel) const;

 private:
    friend class VoxelMaker;
    void close_gaps(std::span<const uint8_t> gaps);
    Grid grid_;
    std::vector<uint32_t> numbers_;   ///< by cell
    std::vector<uint32_t> occupied_;  ///< cells
    std::vector<size_t> starts_;      ///< by occupied voxel: its first part; and the end
    std::vector<SurfelPart> parts_;
    std::vector<uint64_t> blocks_;  ///< by occupied voxel
};

/// Voxels::divide() in steps.
class VoxelMaker {
 public:
    /// `surfels` must outlive this.
    VoxelMaker(std::span<const FlatSurfel> surfels, const Grid& grid);
    /// Divides the next surfels, some hundred thousand. Returns false when all are done. Errors: discs that
    /// together touch too many voxels.
    Result<bool> advance();
    /// Returns the voxels; all surfels must be done.
    Voxels finish();

 private:
    struct CellPart {
        uint32_t cell;
        SurfelPart part;
    };
    void add_parts(const DiscBatch& discs, size_t disc, uint32_t number, std::vector<CellPart>& target);
    void mark(const DiscBatch& discs, size_t disc, const glm::ivec3& cell, uint64_t box);

    std::span<const FlatSurfel> surfels_;
    Grid grid_;
    std::vector<std::vector<CellPart>> pieces_;  ///< of so many surfels each
    // Atomically: several threads find parts in one cell.
    std::vector<uint64_t> blocks_;  ///< by cell: those that discs touch
    std::vector<uint8_t> gaps_;     ///< by cell: of its largest disc
    size_t most_;                   ///< parts
    std::atomic<size_t> parts_{0};
    size_t done_ = 0;  ///< surfels
};

/// Returns whether a surfel occupies voxels.
bool has_disc(const FlatSurfel& surfel);

/// Returns the grid about all discs, with `longest` voxels along its longest side; a grid without voxels if
/// there is no disc.
Grid grid_about(std::span<const FlatSurfel> surfels, uint32_t longest);

}  // namespace lucarne::gi::volume
