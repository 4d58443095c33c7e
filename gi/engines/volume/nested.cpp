#include "gi/engines/volume/nested.h"

#include <algorithm>

#include <glm/common.hpp>

#include "gi/engines/volume/read_back.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

/// Coarse air is looked for so many fine voxels away: walls of coarse voxels reach farther than those of fine
/// ones.
constexpr int kReach = 3, kCellsAlong = 2 * kReach + 1;
constexpr size_t kCellsAtOnce = 256;

using Offsets = std::array<glm::ivec3, size_t{kCellsAlong} * kCellsAlong * kCellsAlong>;

/// The cells about one, the nearest first.
Offsets nearest_first() {
    Offsets offsets;
    for (int i = 0; i < static_cast<int>(offsets.size()); ++i)
        offsets[static_cast<size_t>(i)] =
            glm::ivec3(i % kCellsAlong, i / kCellsAlong % kCellsAlong, i / (kCellsAlong * kCellsAlong)) -
            kReach;
    std::ranges::stable_sort(offsets, {},
                             [](const glm::ivec3& o) { return o.x * o.x + o.y * o.y + o.z * o.z; });
    return offsets;
}

}  // namespace

std::optional<glm::ivec3> coarse_air_at(const Space& coarse, const Space& fine, const glm::ivec3& cell) {
    static const Offsets offsets = nearest_first();
    const glm::vec3 middle = glm::vec3(cell) + 0.5f;
    for (const glm::ivec3& offset : offsets) {
        const glm::ivec3 other = cell + offset;
        if (!fine.voxels.is_air(other)) continue;
        const glm::ivec3 found(glm::floor(coarse.grid().place(fine.grid().middle(other))));
        if (!coarse.grid().holds(found) || !coarse.voxels.is_air(found)) continue;
        if (offset == glm::ivec3(0) || fine.air.sees(middle, glm::vec3(other) + 0.5f)) return found;
    }
    return {};
}

std::vector<glm::vec3> from_coarse(const Space& coarse, std::span<const glm::vec3> irradiance,
                                   const Space& fine) {
    const auto faces = fine.faces.all();
    std::vector<glm::vec3> light(faces.size(), glm::vec3(0.0f));
    parallel_ranges(faces.size(), kCellsAtOnce, [&](size_t first, size_t last) {
        Sights sights(coarse);
        for (size_t i = first; i < last; ++i) {
            const auto air = coarse_air_at(coarse, fine, fine.cell_before(faces[i]));
            if (!air) continue;
            const SurfacePoint at{
                .position = faces[i].position, .normal = faces[i].normal, .radius = fine.grid().voxel};
            light[i] = glm::vec3(irradiance_at(coarse, irradiance, at, *air, sights));
        }
    });
    return light;
}

Border::Border(const Space& coarse, const Space& fine) : fine_size_(fine.grid().size) {
    const Grid &outer = coarse.grid(), &inner = fine.grid();
    // Anchors lie about cells in the fine grid, and the cells that are read about them.
    low_ = glm::max(glm::ivec3(glm::floor(outer.place(inner.low))) - 2, glm::ivec3(0));
    size_ =
        glm::min(glm::ivec3(glm::floor(outer.place(inner.position(glm::vec3(inner.size))))) + 3, outer.size) -
        low_;
    for (int side = 0; side < kSides; ++side) {
        const int axis = axis_of(side), u = (axis + 1) % 3, v = (axis + 2) % 3;
        auto& places = places_[static_cast<size_t>(side)];
        const auto width = static_cast<size_t>(fine_size_[u] + 2);
        places.resize(width * static_cast<size_t>(fine_size_[v] + 2));
        parallel_ranges(places.size(), kCellsAtOnce, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                glm::ivec3 cell;
                cell[axis] = sign_of(side) > 0 ? fine_size_[axis] : -1;
                cell[u] = static_cast<int>(i % width) - 1;
                cell[v] = static_cast<int>(i / width) - 1;
                places[i] = place_of(coarse, fine, cell);
            }
        });
    }
}

/// Returns the place of a cell just outside of the fine grid: about its middle, but in the coarse cell of
/// air, or beside it, that belongs to the next cell in the grid. Coarse cells that touch are in the same air.
Border::Place Border::place_of(const Space& coarse, const Space& fine, const glm::ivec3& cell) const {
    const glm::ivec3 inner = glm::clamp(cell, glm::ivec3(0), fine_size_ - 1);
    if (!fine.voxels.is_air(inner)) return {};
    const auto air = coarse_air_at(coarse, fine, inner);
    if (!air) return {};
    const glm::vec3 low(*air);
    const glm::vec3 middle =
        glm::clamp(coarse.grid().place(fine.grid().middle(cell)), low, low + 1.0f) - 0.5f;
    const glm::ivec3 first = glm::clamp(glm::ivec3(glm::floor(middle)), low_, low_ + size_ - 2);
    return {static_cast<uint32_t>(number(first)), glm::clamp(middle - glm::vec3(first), 0.0f, 1.0f)};
}

}  // namespace lucarne::gi::volume
