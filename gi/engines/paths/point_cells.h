#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/point_grid.h"

namespace lucarne::gi::paths {

/// A PointGrid of gathering points that does not change any more, for many look-ups.
class PointCells {
 public:
    PointCells() = default;
    /// `factor`: of the points' reaches.
    PointCells(std::span<const GatheringPoint> points, float factor);

    /// Calls visit(number) for the points that may reach this position, in the same order on every run.
    template <class Visit>
    void visit(const glm::vec3& position, const Visit& visit) const {
        for (const int grid : grids_) {
            const uint64_t key = PointGrid::key(grid, PointGrid::cell_of(position, grid));
            for (size_t at = place_of(key); table_[at].count > 0; at = (at + 1) & (table_.size() - 1)) {
                if (table_[at].key != key) continue;
                for (uint32_t i = 0; i < table_[at].count; ++i) visit(numbers_[table_[at].first + i]);
                break;
            }
        }
    }

 private:
    struct Cell {
        uint64_t key = 0;
        uint32_t first = 0, count = 0;  ///< in numbers_; 0: a free place
    };
    size_t place_of(uint64_t key) const { return PointGrid::hash(key) & (table_.size() - 1); }

    std::vector<int> grids_;
    std::vector<Cell> table_;  ///< by open addressing; its size is a power of two
    std::vector<uint32_t> numbers_;
};

}  // namespace lucarne::gi::paths
