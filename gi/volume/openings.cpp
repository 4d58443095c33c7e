#include "gi/volume/openings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "gi/tree/coverage.h"
#include "gi/volume/blocks.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kVoxelsAtOnce = 256;
constexpr auto kBlocks = static_cast<float>(kBlocksAlong);

template <class Body>
void for_each_about(const Voxels& voxels, uint32_t voxel, const Body& body) {
    const glm::ivec3 cell = voxels.grid().cell(voxels.occupied()[voxel]);
    for (int i = 0; i < 27; ++i) body(static_cast<size_t>(i), cell + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1);
}

uint64_t all_columns(uint64_t blocks) {
    return free_columns(blocks, 0) | free_columns(blocks, 1) | free_columns(blocks, 2);
}

/// Adds to `blocks` those of a voxel at `low` whose middles a disc covers, as seen along the axis nearest to
/// its normal.
void add_covered(uint64_t& blocks, const FlatSurfel& surfel, const Grid& grid, const glm::vec3& low) {
    const glm::vec3 place = kBlocks * (grid.place({surfel.x, surfel.y, surfel.z}) - low);
    const glm::vec3 normal = decode_octahedral(surfel.normal);
    const float radius = kBlocks * surfel.radius / grid.voxel;
    const int axis = largest_axis(normal), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto first = [&](int along) {
        return static_cast<int>(std::clamp(std::ceil(place[along] - radius - 0.5f), 0.0f, kBlocks));
    };
    const auto last = [&](int along) {
        return static_cast<int>(std::clamp(std::floor(place[along] + radius - 0.5f), -1.0f, kBlocks - 1));
    };
    glm::ivec3 block;
    for (block[v] = first(v); block[v] <= last(v); ++block[v])
        for (block[u] = first(u); block[u] <= last(u); ++block[u]) {
            const float away_u = static_cast<float>(block[u]) + 0.5f - place[u];
            const float away_v = static_cast<float>(block[v]) + 0.5f - place[v];
            const float away = -(normal[u] * away_u + normal[v] * away_v) / normal[axis];
            if (away_u * away_u + away_v * away_v + away * away > radius * radius) continue;
            const float height = std::floor(place[axis] + away);
            if (!(height >= 0 && height < kBlocks)) continue;
            block[axis] = static_cast<int>(height);
            blocks |= block_bit(block);
        }
}

}  // namespace

Openings find_openings(const Voxels& voxels, std::span<const FlatSurfel> surfels) {
    const size_t count = voxels.occupied().size();
    const auto for_each = [&](const auto& body) {
        parallel_ranges(count, kVoxelsAtOnce, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) body(static_cast<uint32_t>(i));
        });
    };
    std::vector<AirAbout> about(count);
    std::vector<uint64_t> columns(count, 0);  // free ones that are connected with the air
    for_each([&](uint32_t voxel) {
        const uint64_t free = all_columns(voxels.blocks(voxel));
        if (free == 0) return;
        uint32_t air = 0;
        for_each_about(voxels, voxel, [&](size_t i, const glm::ivec3& cell) {
            air |= voxels.is_air(cell) ? uint32_t{1} << i : 0;
        });
        about[voxel] = air_about(voxels.blocks_about(voxel), air);
        if (about[voxel].one) columns[voxel] = free & about[voxel].reached;
    });
    Openings openings;
    openings.blocks.resize(count);
    openings.passing.assign(count, glm::vec3(0.0f));
    for_each([&](uint32_t voxel) {
        const uint64_t own = voxels.blocks(voxel);
        openings.blocks[voxel] = own;
        if (columns[voxel] == 0) return;
        std::array<uint64_t, 27> wanted{};
        for_each_about(voxels, voxel, [&](size_t i, const glm::ivec3& cell) {
            const uint32_t other = voxels.at(cell);
            wanted[i] = other != Voxels::kAir ? columns[other] : voxels.is_air(cell) ? kAllBlocks : 0;
        });
        if (!connects(voxels.blocks_about(voxel), wanted)) return;
        for (int axis = 0; axis < 3; ++axis)
            openings.passing[voxel][axis] =
                static_cast<float>(std::popcount(free_columns(~columns[voxel], axis))) / 64;
        uint64_t covered = 0;
        const glm::vec3 low(voxels.grid().cell(voxels.occupied()[voxel]));
        for (const SurfelPart& part : voxels.parts(voxel))
            add_covered(covered, surfels[part.surfel], voxels.grid(), low);
        openings.blocks[voxel] = own & (covered | about[voxel].apart);
    });
    return openings;
}

}  // namespace lucarne::gi::volume
