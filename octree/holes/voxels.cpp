#include "octree/holes/voxels.h"

#include <bit>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "octree/tree/key.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr int kMostCells = (1 << kMaxLevel) - 4;  // along an axis, with one free cell around

constexpr uint32_t kBrickBits = 6;

uint64_t code_of(const glm::ivec3& cell) {
    return morton(static_cast<uint64_t>(cell.x), static_cast<uint64_t>(cell.y),
                  static_cast<uint64_t>(cell.z));
}

bool has_normal(const HolePoint& point) {
    return point.normal != glm::vec3(0.0f);
}

}  // namespace

Voxels::Voxels(const HoleSample& sample, float size)
    : size_(size), of_point_(sample.points.size(), kNoVoxel) {
    origin_ = glm::vec3(std::numeric_limits<float>::max());
    for (const HolePoint& point : sample.points) origin_ = glm::min(origin_, point.position);
    std::vector<CodeIndex> sorted;
    sorted.reserve(sample.points.size());
    for (uint32_t i = 0; i < sample.points.size(); ++i) {
        if (!has_normal(sample.points[i])) continue;
        const glm::ivec3 cell = cell_of(sample.points[i].position);
        sorted.push_back({code_of(cell), i});
    }
    sort_by_code(sorted, 3 * kMaxLevel);
    for (size_t at = 0; at < sorted.size();) {
        Voxel voxel;
        const uint64_t code = sorted[at].code;
        cells_.push_back(cell_of(sample.points[sorted[at].index].position));
        for (; at < sorted.size() && sorted[at].code == code; ++at) {
            const HolePoint& point = sample.points[sorted[at].index];
            voxel.position += point.position;
            voxel.normal += point.normal;
            voxel.colour += point.colour;
            voxel.points += 1;
            of_point_[sorted[at].index] = static_cast<uint32_t>(voxels_.size());
        }
        voxel.position /= voxel.points;
        voxel.normal /= voxel.points;
        voxel.colour /= voxel.points;
        voxels_.push_back(voxel);
    }
    enter_bricks();
}

void Voxels::enter_bricks() {
    size_t bricks = 0;
    for (size_t i = 0; i < cells_.size(); ++i)
        bricks += i == 0 || code_of(cells_[i]) >> kBrickBits != code_of(cells_[i - 1]) >> kBrickBits;
    bricks_.assign(std::bit_ceil(2 * bricks + 1), Brick{});
    for (uint32_t i = 0; i < cells_.size(); ++i) {
        const uint64_t code = code_of(cells_[i]);
        Brick& brick = bricks_[slot_of(code >> kBrickBits)];
        if (brick.mask == 0) brick = {code >> kBrickBits, 0, i};
        brick.mask |= uint64_t{1} << (code & 63);
    }
}

glm::ivec3 Voxels::cell_of(const glm::vec3& position) const {
    const glm::vec3 cell = (position - origin_) / size_;
    return glm::ivec3(glm::clamp(cell, glm::vec3(-1.0f), glm::vec3(float{kMostCells - 1})) + 1.0f);
}

/// Returns the slot of a brick, or the free one where it belongs.
size_t Voxels::slot_of(uint64_t brick) const {
    const size_t mask = bricks_.size() - 1;
    size_t slot = (brick * 0x9e3779b97f4a7c15ull >> 24) & mask;
    while (bricks_[slot].code != UINT64_MAX && bricks_[slot].code != brick) slot = (slot + 1) & mask;
    return slot;
}

uint32_t Voxels::find(const glm::ivec3& cell) const {
    const uint64_t code = code_of(cell), bit = uint64_t{1} << (code & 63);
    const Brick& brick = bricks_[slot_of(code >> kBrickBits)];
    if (!(brick.mask & bit)) return kNoVoxel;
    return brick.first + static_cast<uint32_t>(std::popcount(brick.mask & (bit - 1)));
}

}  // namespace lucarne::octree
