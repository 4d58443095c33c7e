#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi::paths {

/// Finds the points in whose reach a position lies: grids of cells, each twice as large as those of the one
/// before. A point is listed in every cell that its reach touches, of the grid whose cells are 1 to 2 times
/// as large as its reach.
class PointGrid {
 public:
    void clear() { cells_.clear(), grids_ = 0; }
    /// Adds a point with this number and reach, m.
    void add(uint32_t number, const glm::vec3& position, float reach) {
        grids_ |= uint64_t{1} << grid_of(reach);
        for_each_cell(position, reach, [&](uint64_t key) { cells_[key].push_back(number); });
    }
    /// Returns whether test(number) holds for any of the points that may reach this position.
    template <class Test>
    bool any_of(const glm::vec3& position, const Test& test) const {
        for (uint64_t grids = grids_; grids != 0; grids &= grids - 1) {
            const int grid = std::countr_zero(grids);
            const auto found = cells_.find(key(grid, cell_of(position, grid)));
            if (found != cells_.end() && std::ranges::any_of(found->second, test)) return true;
        }
        return false;
    }

    /// The number of the grid for points with this reach.
    static int grid_of(float reach) {
        const int exponent = static_cast<int>(std::ceil(std::log2(std::max(reach, 1e-6f))));
        return std::min(std::max(exponent + kMiddle, 0), kGrids - 1);
    }
    static glm::ivec3 cell_of(const glm::vec3& position, int grid) {
        const glm::vec3 at = glm::floor(position * std::ldexp(1.0f, kMiddle - grid));
        return glm::ivec3(glm::clamp(at, -1e9f, 1e9f));
    }
    /// Names a cell. Far cells may share a name: their points are visited in vain.
    static uint64_t key(int grid, const glm::ivec3& cell) {
        const auto bits = [](int v) { return static_cast<uint64_t>(v) & ((uint64_t{1} << kBits) - 1); };
        return static_cast<uint64_t>(grid) << 3 * kBits | bits(cell.z) << 2 * kBits | bits(cell.y) << kBits |
               bits(cell.x);
    }
    static size_t hash(uint64_t key) { return key * 0x9e3779b97f4a7c15ull >> 20; }
    /// Calls visit(key) for the cells that a ball touches.
    template <class Visit>
    static void for_each_cell(const glm::vec3& position, float reach, const Visit& visit) {
        const int grid = grid_of(reach);
        const float edge = std::ldexp(1.0f, grid - kMiddle);
        const glm::ivec3 low = cell_of(position - reach, grid), high = cell_of(position + reach, grid);
        for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
                for (int x = low.x; x <= high.x; ++x) {
                    const glm::vec3 corner = glm::vec3(x, y, z) * edge;
                    const glm::vec3 away = position - glm::clamp(position, corner, corner + edge);
                    if (glm::dot(away, away) <= reach * reach * 1.0001f) visit(key(grid, {x, y, z}));
                }
    }

 private:
    static constexpr int kGrids = 40, kMiddle = 20;  ///< cells of 2^-20 to 2^19 m
    static constexpr int kBits = 19;                 ///< of a coordinate of a cell

    struct Hash {
        size_t operator()(uint64_t key) const { return hash(key); }
    };
    std::unordered_map<uint64_t, std::vector<uint32_t>, Hash> cells_;
    uint64_t grids_ = 0;
};

}  // namespace lucarne::gi::paths
