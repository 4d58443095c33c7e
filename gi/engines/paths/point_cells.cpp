#include "gi/engines/paths/point_cells.h"

#include <bit>

namespace lucarne::gi::paths {

PointCells::PointCells(std::span<const GatheringPoint> points, float factor) {
    struct Listed {
        uint64_t key;
        uint32_t number;
        auto operator<=>(const Listed&) const = default;
    };
    std::vector<Listed> entries;
    for (uint32_t i = 0; i < points.size(); ++i) {
        const float reach = factor * points[i].reach;
        const int grid = PointGrid::grid_of(reach);
        if (std::ranges::find(grids_, grid) == grids_.end()) grids_.push_back(grid);
        PointGrid::for_each_cell(points[i].position, reach, [&](uint64_t key) {
            entries.push_back({key, i});
        });
    }
    std::ranges::sort(grids_);
    std::ranges::sort(entries);
    size_t cells = 0;
    for (size_t i = 0; i < entries.size(); ++i) cells += i == 0 || entries[i].key != entries[i - 1].key;
    table_.resize(std::bit_ceil(2 * cells + 1));
    for (size_t first = 0; first < entries.size();) {
        size_t last = first;
        const size_t begin = numbers_.size();
        while (last < entries.size() && entries[last].key == entries[first].key)
            numbers_.push_back(entries[last++].number);
        numbers_.resize((numbers_.size() + kListed - 1) / kListed * kListed, kNone);
        size_t at = place_of(entries[first].key);
        while (table_[at].count > 0) at = (at + 1) & (table_.size() - 1);
        table_[at] = {entries[first].key, static_cast<uint32_t>(begin), static_cast<uint32_t>(last - first)};
        first = last;
    }
}

}  // namespace lucarne::gi::paths
