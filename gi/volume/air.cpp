#include "gi/volume/air.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "gi/volume/blocks.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

/// For a row of cells, `stride` apart: the largest of the distance along the row to a cell and of that cell's
/// own distance, at the cell where it is least. Repeated over all axes this is the distance of
/// Air::distance().
void spread(std::vector<uint8_t>& distances, size_t first, size_t stride, int count,
            std::vector<uint8_t>& row) {
    row.resize(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i)
        row[static_cast<size_t>(i)] = distances[first + static_cast<size_t>(i) * stride];
    for (int i = 0; i < count; ++i) {
        int least = row[static_cast<size_t>(i)];
        for (int away = 1; away < least; ++away) {
            if (i - away >= 0)
                least = std::min(least, std::max<int>(away, row[static_cast<size_t>(i - away)]));
            if (i + away < count)
                least = std::min(least, std::max<int>(away, row[static_cast<size_t>(i + away)]));
        }
        distances[first + static_cast<size_t>(i) * stride] = static_cast<uint8_t>(least);
    }
}

}  // namespace

Air::Air(const Voxels& voxels, std::span<const FlatSurfel> surfels)
    : grid_(voxels.grid()),
      numbers_(voxels.numbers().begin(), voxels.numbers().end()),
      openings_(find_openings(voxels, surfels)) {
    const auto numbers = voxels.numbers();
    distances_.resize(numbers.size());
    std::ranges::transform(numbers, distances_.begin(),
                           [](uint32_t number) { return number == Voxels::kAir ? 255 : 0; });
    const glm::ivec3 size = grid_.size;
    const size_t strides[] = {1, static_cast<size_t>(size.x), static_cast<size_t>(size.x) * size.y};
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        parallel_ranges(static_cast<size_t>(size[u]), 8, [&](size_t begin, size_t end) {
            std::vector<uint8_t> row;
            for (size_t i = begin; i < end; ++i)
                for (size_t j = 0; j < static_cast<size_t>(size[v]); ++j)
                    spread(distances_, i * strides[u] + j * strides[v], strides[axis], size[axis], row);
        });
    }
}

/// Returns whether no block of an occupied voxel is on a line between two places on its sides, or in it.
bool Air::sees_in(const glm::ivec3& cell, const glm::vec3& from, const glm::vec3& to) const {
    const uint64_t blocks = openings_.blocks[numbers_[grid_.number(cell)]];
    if (blocks == kAllBlocks) return false;
    constexpr auto kAlong = static_cast<float>(kBlocksAlong);
    const glm::vec3 start = kAlong * (from - glm::vec3(cell)), way = kAlong * (to - from);
    const auto block_at = [](const glm::vec3& place) {
        return glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), glm::ivec3(kBlocksAlong - 1));
    };
    glm::ivec3 block = block_at(start);
    const glm::ivec3 end = block_at(start + way);
    while ((blocks & block_bit(block)) == 0) {
        if (block == end) return true;
        // To the next block, through the face that the line meets first.
        float nearest = std::numeric_limits<float>::infinity();
        int through = -1;
        for (int axis = 0; axis < 3; ++axis) {
            if (block[axis] == end[axis]) continue;
            const int border = end[axis] > block[axis] ? block[axis] + 1 : block[axis];
            const float at = (static_cast<float>(border) - start[axis]) / way[axis];
            if (at >= nearest && through >= 0) continue;
            nearest = at;
            through = axis;
        }
        block[through] += end[through] > block[through] ? 1 : -1;
    }
    return false;
}

bool Air::sees(const glm::vec3& from, const glm::vec3& to) const {
    const glm::vec3 way = to - from;
    const glm::ivec3 most = grid_.size - 1;
    glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(from)), glm::ivec3(0), most);
    const glm::ivec3 end = glm::clamp(glm::ivec3(glm::floor(to)), glm::ivec3(0), most);
    // The line crosses the border b of an axis at b * inverse - start of its way, at no place if it is level.
    glm::ivec3 step;
    glm::vec3 inverse, start;
    for (int axis = 0; axis < 3; ++axis) {
        const bool level = !(std::abs(way[axis]) > 1e-9f);
        step[axis] = way[axis] < 0 ? -1 : 1;
        inverse[axis] = level ? 0 : 1 / way[axis];
        start[axis] = level ? -std::numeric_limits<float>::infinity() : from[axis] * inverse[axis];
    }
    // Crosses cubes of free cells at a time; ends when the last cell is in the cube.
    const int limit = 3 * (most.x + most.y + most.z + 3);
    float entered = 0;  // share of the way at which the line came into the cell
    for (int i = 0; i < limit; ++i) {
        const int distance = distances_[grid_.number(cell)], free = std::max(distance, 1);
        const glm::ivec3 away = glm::abs(end - cell);
        const bool last = std::max({away.x, away.y, away.z}) < free;
        if (last && distance > 0) return true;
        const auto border_at = [&](int axis) {
            const int border = cell[axis] + (step[axis] > 0 ? free : 1 - free);
            return static_cast<float>(border) * inverse[axis] - start[axis];
        };
        const float x = border_at(0), y = border_at(1), z = border_at(2);
        const float nearest = std::min({x, y, z});
        const float left = last ? 1.0f : nearest;
        if (distance == 0 && !sees_in(cell, from + way * entered, from + way * left)) return false;
        if (last) return true;
        entered = nearest;
        const glm::vec3 place = from + way * nearest;
        const int through = x <= nearest ? 0 : y <= nearest ? 1 : 2;
        // The line never turns back, and stays in the cube along the other axes, so it is in the grid.
        const auto next = [&](int axis) {
            const int low = cell[axis] - (step[axis] > 0 ? 0 : free - 1);
            return std::clamp(static_cast<int>(place[axis]), low, low + free - 1);
        };
        glm::ivec3 there(next(0), next(1), next(2));
        there[through] = cell[through] + step[through] * free;
        if (there[through] < 0 || there[through] > most[through]) return false;
        cell = glm::clamp(there, glm::ivec3(0), most);
    }
    return false;
}

}  // namespace lucarne::gi::volume
