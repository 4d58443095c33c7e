// Discs divided among voxels and their blocks.
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <vector>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"
#include "gi/volume/disc_shares.h"
#include "gi/volume/native/discs.h"
#include "io/core/random.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::volume {
namespace {

TEST(DiscShares, AreThoseOfPointsSpreadOverTheDisc) {
    Random random(5);
    const auto uniform = [&](double least, double most) {
        return static_cast<float>(least + (most - least) * random.uniform());
    };
    EXPECT_FLOAT_EQ(disc_share(0), .5f);
    EXPECT_FLOAT_EQ(disc_share(2), 1);
    EXPECT_FLOAT_EQ(disc_share(-2), 0);
    EXPECT_NEAR(disc_share(0, 0, 0), .25f, 1e-6f);
    constexpr int kPoints = 20000;
    for (int i = 0; i < 200; ++i) {
        const float angle = uniform(0, 3.14159265), cosine = std::cos(angle), sine = std::sin(angle);
        const float first = uniform(-1.3, 1.3), second = uniform(-1.3, 1.3);
        int before_first = 0, before_both = 0;
        for (int k = 0; k < kPoints; ++k) {  // a spiral by the golden angle
            const float r = std::sqrt((static_cast<float>(k) + .5f) / kPoints),
                        turn = 2.39996323f * static_cast<float>(k);
            const float x = r * std::cos(turn), y = r * std::sin(turn);
            before_first += x <= first;
            before_both += x <= first && cosine * x + sine * y <= second;
        }
        EXPECT_NEAR(disc_share(first), static_cast<float>(before_first) / kPoints, .003f) << first;
        EXPECT_NEAR(disc_share(first, second, cosine), static_cast<float>(before_both) / kPoints, .003f)
            << first << " " << second << " " << angle;
    }
}

TEST(DiscShares, AreThoseOfTheOctagonsPartsAndTouchTheSameVoxels) {
    const Grid grid{glm::vec3(0), 1, glm::ivec3(8)};
    Random random(6);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    std::array<size_t, 5> kinds{};
    for (int i = 0; i < 3000; ++i) {
        const float nx = uniform() - .5f, ny = uniform() - .5f, nz = uniform() - .5f;
        const uint32_t code = encode_octahedral(
            glm::normalize(i % 3 == 0 ? glm::vec3(nx, .01f * ny, .01f * nz) : glm::vec3(nx, ny, nz)));
        const glm::vec3 normal = decode_octahedral(code);
        const float x = uniform(), y = uniform(), z = uniform(), radius = .35f * uniform() + .1f;
        const glm::vec3 place = glm::vec3(3) + 2.0f * glm::vec3(x, y, z);
        const FlatSurfel surfel{.x = place.x,
                                .y = place.y,
                                .z = place.z,
                                .radius = radius,
                                .area = 1,
                                .normal = code,
                                .albedo = kSurfelHasNormal};
        DiscBatch discs;
        prepare_discs({&surfel, 1}, grid, discs);
        std::array<DiscPart, 4> parts;
        const size_t few = few_parts(discs, 0, parts);
        ++kinds[few];
        if (few == 0) continue;
        std::map<uint32_t, float> polygons;
        float all = 0, sum = 0;
        for_each_voxel(grid, place, normal, radius, [&](const glm::ivec3& cell, const Polygon& part) {
            polygons[grid.number(cell)] = part.area();
            all += part.area();
        });
        for (size_t k = 0; k < few; ++k) {
            const auto found = polygons.find(grid.number(parts[k].cell));
            ASSERT_NE(found, polygons.end()) << "a voxel that the octagon does not touch";
            EXPECT_GT(parts[k].share, 0);
            // In the border of two voxels the octagon counts in both.
            if (i % 3 != 0) {
                EXPECT_NEAR(parts[k].share, found->second / all, .03f);
            }
            const glm::vec3 corner(parts[k].cell), across = glm::sqrt(1.0f - normal * normal);
            const glm::vec3 low = place - radius * across - kTouching,
                            high = place + radius * across + kTouching;
            EXPECT_EQ(parts[k].box, blocks_in_box(4.0f * (low - corner), 4.0f * (high - corner)));
            sum += parts[k].share;
            polygons.erase(found);
        }
        EXPECT_NEAR(sum, 1, 1e-5f);
        for (const auto& [cell, area] : polygons) EXPECT_LT(area / all, .005f) << "corners of the octagon";
    }
    for (const size_t kind : kinds) EXPECT_GT(kind, 30u) << "each number of parts is met";
}

/// The blocks of a voxel that a polygon touches, by clipping it. `polygon`: in units of blocks.
uint64_t blocks_of(const Polygon& polygon) {
    uint64_t touched = 0;
    for_each_voxel_of(glm::ivec3(kBlocksAlong), polygon, kTouchingBlocks,
                      [&](const glm::ivec3& block, const Polygon&) { touched |= block_bit(block); });
    return touched;
}

TEST(Blocks, ThatADiscTouchesAreThoseThatItsOctagonIsClippedTo) {
    const Grid grid{glm::vec3(0), 1, glm::ivec3(kBlocksAlong)};
    Random random(8);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    int all = 0, others = 0;
    for (int i = 0; i < 3000; ++i) {
        const float nx = uniform() - .5f, ny = uniform() - .5f, nz = uniform() - .5f;
        const glm::vec3 normal =
            glm::normalize(i % 3 == 0 ? glm::vec3(nx, .01f * ny, .01f * nz) : glm::vec3(nx, ny, nz));
        const float x = uniform(), y = uniform(), z = uniform(), radius = 3 * uniform() + .05f;
        const glm::vec3 place = 6.0f * glm::vec3(x, y, z) - 1.0f;
        const uint64_t clipped = blocks_of(octagon_about(grid, place, normal, radius));
        const Octagon octagon(normal, radius);
        const glm::vec3 reach(octagon.reach(kX), octagon.reach(kY), octagon.reach(kZ));
        const uint64_t box = glm::all(glm::lessThan(glm::abs(place - 2.0f), reach + 2.0f + kTouchingBlocks))
                                 ? blocks_in_box(place - reach, place + reach)
                                 : 0;
        const uint64_t touched = blocks_touched(box, place, normal, radius);
        others += std::popcount(clipped ^ touched);
        all += std::popcount(clipped);
    }
    EXPECT_GT(all, 10000);
    EXPECT_LE(others, all / 5000) << "where rounding decides";
    const uint64_t floor = blocks_touched(0x77u << 16, {1, 1, 1.2f}, {0, 0, 1}, .9f);
    EXPECT_EQ(floor, 0x33u << 16) << "2 x 2 blocks of the second layer";
    EXPECT_EQ(std::popcount(free_columns(floor, 2)), 4 * (16 - 4));
    EXPECT_EQ(std::popcount(free_columns(floor, 0)), 4 * (16 - 2));
    EXPECT_EQ(free_columns(kAllBlocks, 1), 0u);
}

TEST(DiscBatch, HoldsOfEachDiscWhatItIsOfAloneAndItsShareBeforeABorder) {
    const Grid grid{glm::vec3(-1, -2, -3), .5f, glm::ivec3(16)};
    Random random(9);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    std::vector<FlatSurfel> surfels;
    for (size_t i = 0; i < DiscBatch::kMost - 3; ++i) {
        const float nx = uniform() - .5f, ny = uniform() - .5f, nz = uniform() - .5f;
        const float x = uniform(), y = uniform(), z = uniform();
        surfels.push_back({.x = x,
                           .y = y,
                           .z = z,
                           .radius = .1f + .1f * uniform(),
                           .area = i % 2 == 0 ? 0 : .002f,
                           .normal = encode_octahedral(glm::normalize(glm::vec3(nx, ny, nz))),
                           .albedo = kSurfelHasNormal});
    }
    DiscBatch together, alone;
    prepare_discs(surfels, grid, together);
    for (size_t i = 0; i < surfels.size(); ++i) {
        prepare_discs({&surfels[i], 1}, grid, alone);
        const float radius = surfels[i].radius / grid.voxel, area = surfels[i].area;
        EXPECT_FLOAT_EQ(together.radius[i], radius);
        const float share = area > 0 ? area : 3.14159265f * surfels[i].radius * surfels[i].radius;
        EXPECT_FLOAT_EQ(together.area[i], share);
        EXPECT_EQ(together.gap[i], gap_between(radius, share / (grid.voxel * grid.voxel)));
        for (size_t axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(together.below[axis][i], alone.below[axis][0]);
            EXPECT_EQ(together.last[axis][i], alone.last[axis][0]);
            EXPECT_EQ(together.low_block[axis][i], alone.low_block[axis][0]);
            EXPECT_NEAR(together.below[axis][i], disc_share(together.distance[axis][i]), 1e-6f);
            EXPECT_EQ(
                together.first[axis][i],
                static_cast<int>(together.place[axis][i] - radius * together.across[axis][i] - kTouching));
        }
    }
}

}  // namespace
}  // namespace lucarne::gi::volume
