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

    /// Calls visit(first, count) for the lists of the points that may reach this position: `count` of
    /// numbers() from `first` on, in the same order on every run.
    template <class Visit>
    void visit_lists(const glm::vec3& position, const Visit& visit) const {
        for (const int grid : grids_) {
            const uint64_t key = PointGrid::key(grid, PointGrid::cell_of(position, grid));
            for (size_t at = place_of(key); table_[at].count > 0; at = (at + 1) & (table_.size() - 1)) {
                if (table_[at].key != key) continue;
                visit(table_[at].first, table_[at].count);
                break;
            }
        }
    }
    /// Calls visit(number) for these points.
    template <class Visit>
    void visit(const glm::vec3& position, const Visit& visit) const {
        visit_lists(position, [&](uint32_t first, uint32_t count) {
            for (uint32_t i = 0; i < count; ++i) visit(numbers_[first + i]);
        });
    }
    /// All lists. Each begins at a multiple of kListed; kNone fills the rest.
    static constexpr size_t kListed = 8;
    std::span<const uint32_t> numbers() const { return numbers_; }

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
