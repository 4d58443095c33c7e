#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/shared/brdf.h"
#include "gi/volume/air.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"
#include "gi/volume/faces.h"
#include "gi/volume/openings.h"
#include "gi/volume/voxels.h"
#include "io/core/random.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi::volume {
namespace {

constexpr uint32_t kVoxels = 32;

Voxels divided(const std::vector<FlatSurfel>& surfels, const Grid& grid) {
    auto voxels = Voxels::divide(surfels, grid);
    EXPECT_TRUE(voxels) << voxels.error().line();
    return voxels ? std::move(*voxels) : Voxels{};
}

/// A square sheet with this normal about (1, 1, 1), in discs as small as voxels.
std::vector<FlatSurfel> sheet(const glm::vec3& normal, float side, int n) {
    const glm::vec3 helper = std::abs(normal.z) < .9f ? kZ : kX;
    const glm::vec3 u = side * glm::normalize(glm::cross(helper, normal)), v = glm::cross(normal, u);
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, glm::vec3(1) - .5f * (u + v), u, v, n, glm::vec3(.5f));
    return flat::of(surfels);
}

TEST(DiscAreas, PartsOfADiscAreThoseOfItsOctagon) {
    const Grid grid{glm::vec3(0), 0.25f, glm::ivec3(8)};
    Random random(1);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 normal = glm::normalize(glm::vec3(uniform(), uniform(), uniform()) - .5f);
        const glm::vec3 middle = glm::vec3(.8f) + .4f * glm::vec3(uniform(), uniform(), uniform());
        const float radius = .5f * uniform() + .01f;
        float sum = 0;
        std::map<uint32_t, float> parts;
        for_each_voxel(grid, middle, normal, radius, [&](const glm::ivec3& cell, const Polygon& part) {
            sum += part.area();
            EXPECT_TRUE(parts.emplace(grid.number(cell), part.area()).second) << "a voxel twice";
        });
        const float octagon = 8 * std::tan(3.14159265f / 8) * radius * radius / (.25f * .25f);
        // Voxels overlap by the width within which they count as touched.
        EXPECT_LE(sum / octagon, 1.04f);
        EXPECT_GE(sum, .999f * octagon);
        // Points of the disc lie in voxels that it touches.
        glm::vec3 u = glm::normalize(glm::cross(normal, std::abs(normal.x) < .9f ? kX : kY));
        const glm::vec3 v = glm::cross(normal, u);
        for (int k = 0; k < 50; ++k) {
            const float r = radius * std::sqrt(uniform()), phi = 6.2831853f * uniform();
            const glm::vec3 at = middle + r * (std::cos(phi) * u + std::sin(phi) * v);
            EXPECT_TRUE(parts.contains(grid.number(glm::ivec3(grid.place(at)))));
        }
    }
}

TEST(DiscAreas, AHalfOfADiscLiesOnEitherSideOfItsMiddle) {
    const Grid grid{glm::vec3(-1), 1, glm::ivec3(2)};
    for_each_voxel(grid, glm::vec3(0, -.5f, -.5f), kZ, .3f, [&](const glm::ivec3& cell, const Polygon& part) {
        EXPECT_EQ(cell.y, 0);
        EXPECT_EQ(cell.z, 0);
        EXPECT_NEAR(part.area(), .5f * 8 * std::tan(3.14159265f / 8) * .09f, 1e-3f);
    });
}

TEST(Voxels, AreasOfPartsAddUpToThoseOfTheSurfels) {
    const auto surfels = flat::noisy_room(20000);
    const Voxels voxels = divided(surfels, grid_about(surfels, kVoxels));
    std::vector<double> areas(surfels.size(), 0);
    for (uint32_t voxel = 0; voxel < voxels.occupied().size(); ++voxel)
        for (const SurfelPart& part : voxels.parts(voxel)) areas[part.surfel] += part.area;
    for (size_t i = 0; i < surfels.size(); ++i) ASSERT_NEAR(areas[i] / surfels[i].area, 1, 1e-4);
}

TEST(Voxels, SurfelsWithoutADiscTakeNoRoom) {
    auto surfels = flat::square(4, 1);
    surfels[0].radius = 0;
    surfels[1].radius = NAN;
    surfels[2].x = INFINITY;
    surfels[3].albedo &= ~kSurfelHasNormal;
    const std::vector<FlatSurfel> none(surfels.begin(), surfels.begin() + 4);
    EXPECT_EQ(grid_about(none, kVoxels), Grid{});
    EXPECT_TRUE(divided(none, Grid{}).occupied().empty());
    const Voxels voxels = divided(surfels, grid_about(surfels, kVoxels));
    for (uint32_t voxel = 0; voxel < voxels.occupied().size(); ++voxel)
        for (const SurfelPart& part : voxels.parts(voxel)) EXPECT_GE(part.surfel, 4u);
}

TEST(Voxels, DiscsThatAreFarTooLargeAreAnErrorAndNotAFlood) {
    auto surfels = flat::square(200, 1);
    for (FlatSurfel& s : surfels) s.radius = 1e30f;
    const auto voxels = Voxels::divide(surfels, grid_about(surfels, 64));
    ASSERT_FALSE(voxels);
    EXPECT_NE(voxels.error().line().find("--voxels"), std::string::npos);
}

TEST(Voxels, AreTheSameForAnyNumberOfThreads) {
    const auto surfels = flat::noisy_room(50000);
    const Grid grid = grid_about(surfels, kVoxels);
    const Voxels all = divided(surfels, grid);
    const ThreadLimit limit(1);
    const Voxels one = divided(surfels, grid);
    ASSERT_EQ(all.occupied().size(), one.occupied().size());
    for (uint32_t voxel = 0; voxel < all.occupied().size(); ++voxel)
        EXPECT_TRUE(std::ranges::equal(all.parts(voxel), one.parts(voxel), [](auto& a, auto& b) {
            return a.surfel == b.surfel && a.area == b.area;
        }));
    // Which disc of a voxel comes first decides nothing, either.
    const std::vector<FlatSurfel> turned(surfels.rbegin(), surfels.rend());
    const Voxels reversed = divided(turned, grid);
    ASSERT_TRUE(std::ranges::equal(reversed.occupied(), one.occupied()));
    size_t other = 0;
    for (uint32_t voxel = 0; voxel < one.occupied().size(); ++voxel) {
        EXPECT_EQ(all.blocks(voxel), one.blocks(voxel));
        other += reversed.blocks(voxel) != one.blocks(voxel);
    }
    EXPECT_EQ(other, 0u);
}

TEST(Voxels, WhatEndsBesideABorderHasNoEmptyParts) {
    std::vector<FlatSurfel> surfels = flat::square(2, 1);
    surfels.resize(1);
    surfels[0].x = 1.2495f, surfels[0].y = 1.1f, surfels[0].z = 1.1f, surfels[0].radius = .2f;
    const Grid grid{glm::vec3(0), 0.25f, glm::ivec3(12)};
    for (const float ends : {1.2495f, 1.25f, 1.2499f}) {
        surfels[0].x = ends - surfels[0].radius;
        const Voxels voxels = divided(surfels, grid);
        float sum = 0;
        for (uint32_t voxel = 0; voxel < voxels.occupied().size(); ++voxel)
            for (const SurfelPart& part : voxels.parts(voxel)) {
                EXPECT_GT(part.area, 0) << ends;
                sum += part.area;
            }
        EXPECT_NEAR(sum / surfels[0].area, 1, 1e-5) << ends;
    }
}

/// Counts the air cells that are reached from a cell by steps to any of 26 neighbours.
std::vector<uint8_t> flood(const Voxels& voxels, const glm::ivec3& from) {
    const Grid& grid = voxels.grid();
    std::vector<uint8_t> reached(grid.cells(), 0);
    std::vector<glm::ivec3> waiting = {from};
    reached[grid.number(from)] = 1;
    while (!waiting.empty()) {
        const glm::ivec3 cell = waiting.back();
        waiting.pop_back();
        for (int i = 0; i < 27; ++i) {
            const glm::ivec3 next = cell + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
            if (!grid.holds(next) || !voxels.is_air(next) || reached[grid.number(next)]) continue;
            reached[grid.number(next)] = 1;
            waiting.push_back(next);
        }
    }
    return reached;
}

TEST(Voxels, WallsOfAnyDirectionStopDiagonalSteps) {
    Random random(2);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    for (int i = 0; i < 30; ++i) {
        glm::vec3 normal = glm::normalize(glm::vec3(uniform(), uniform(), uniform()) - .5f);
        if (i == 0) normal = kZ;
        if (i == 1) normal = glm::normalize(glm::vec3(1, 0, 1));
        if (i == 2) normal = glm::normalize(glm::vec3(1, 1, 1));
        const auto surfels = sheet(normal, 4, 200);
        // A grid inside the sheet, in whose borders and diagonals the wall may lie.
        const Grid grid{glm::vec3(.5f), 1.0f / 16, glm::ivec3(16)};
        const Voxels voxels = divided(surfels, grid);
        const auto front = glm::ivec3(normal.x > 0 ? 15 : 0, normal.y > 0 ? 15 : 0, normal.z > 0 ? 15 : 0);
        if (!voxels.is_air(front)) continue;
        const auto reached = flood(voxels, front);
        for (uint32_t cell = 0; cell < grid.cells(); ++cell)
            if (reached[cell]) {
                EXPECT_GT(glm::dot(grid.middle(grid.cell(cell)) - glm::vec3(1), normal), 0) << i;
            }
    }
}

TEST(Blocks, GapsBetweenDiscsAreAsWideAsTheirCoverageTells) {
    // Radius of a fifth of a block.
    constexpr float kRadius = .05f;
    const auto gap = [](float radius, float coverage) {
        return gap_between(radius, kPi * radius * radius / coverage);
    };
    EXPECT_EQ(gap(kRadius, 20), 1) << "none";
    EXPECT_EQ(gap(kRadius, 5), 1) << "1.3 radii: within a block";
    EXPECT_EQ(gap(4 * kRadius, 5), 2);
    EXPECT_EQ(gap(4 * kRadius, 1.7f), 3);
    EXPECT_GT(gap(8 * kRadius, 1.7f), kWidestGap);
}

/// Blocks of 3 x 3 x 3 voxels of which those are taken for which taken(block) is true.
template <class Taken>
std::array<uint64_t, 27> blocks_where(const Taken& taken) {
    std::array<uint64_t, 27> blocks{};
    for (int i = 0; i < 12 * 12 * 12; ++i) {
        const glm::ivec3 block(i % 12, i / 12 % 12, i / 144), voxel = block / kBlocksAlong;
        if (taken(block))
            blocks[static_cast<size_t>(voxel.x + 3 * voxel.y + 9 * voxel.z)] |=
                block_bit(block - kBlocksAlong * voxel);
    }
    return blocks;
}

TEST(Blocks, WithoutGapsNarrowHolesOfAWallAreClosedAndWideOnesStayAsTheyAre) {
    for (const int hole : {1, 2, 3, 4}) {
        const auto wall = blocks_where([&](const glm::ivec3& b) {
            return b.z == 5 && (b.x < 4 || b.x >= 4 + hole || b.y < 4 || b.y >= 4 + hole);
        });
        const auto closed = blocks_where([](const glm::ivec3& b) { return b.z == 5; });
        for (int gap = 1; gap <= kWidestGap; ++gap)
            EXPECT_EQ(without_gaps(wall, gap), gap > hole ? closed[13] : wall[13]) << hole << ' ' << gap;
    }
}

TEST(Blocks, WithoutGapsAWallWithAStepInAGapIsClosed) {
    // Its left half is one block lower: from below a cube reaches into the gap up to the right half's height,
    // and from above down to the left one's.
    const auto wall =
        blocks_where([](const glm::ivec3& b) { return b.x < 5 ? b.z == 5 : b.x > 6 && b.z == 6; });
    const uint64_t closed = without_gaps(wall, 3);
    for (int z = 0; z < kBlocksAlong; ++z)
        for (int x = 0; x < kBlocksAlong; ++x)
            EXPECT_EQ((closed & block_bit({x, 0, z})) != 0, z == 1 || z == 2) << x << ' ' << z;
}

TEST(Blocks, AWallSeparatesTheAirOnItsSidesUnlessItHasAnOpening) {
    std::array<uint64_t, 27> blocks{};
    for (int i = 9; i < 18; ++i) blocks[i] = 0xffffu << 16;  // a wall across the middle layer of voxels
    constexpr uint32_t kAir = 0777000777;                    // the layers below and above it
    EXPECT_FALSE(air_about(blocks, kAir).one);
    blocks[9] &= ~(uint64_t{1} << 16);  // a hole of one block in a corner
    const AirAbout open = air_about(blocks, kAir);
    EXPECT_TRUE(open.one);
    EXPECT_EQ(open.reached, ~blocks[13]);
    EXPECT_EQ(open.apart, 0u);
}

TEST(Blocks, HollowsOfAWallAreApartFromTheAirAtAnOpening) {
    // A wall of two sheets, blocks 4 and 7 along z, that ends in the middle of the middle voxel.
    const auto wall = [](bool closed_end) {
        return blocks_where([&](const glm::ivec3& b) {
            return b.x < 6 && (b.z == 4 || b.z == 7 || (closed_end && b.x == 5 && b.z > 4 && b.z < 7));
        });
    };
    constexpr uint32_t kAir = 0777000777;
    const AirAbout closed = air_about(wall(true), kAir), open = air_about(wall(false), kAir);
    EXPECT_TRUE(closed.one);
    EXPECT_TRUE(open.one);
    for (int x = 0; x < kBlocksAlong; ++x) {
        EXPECT_EQ((closed.reached & block_bit({x, 1, 1})) != 0, x > 1) << x;
        EXPECT_EQ((closed.apart & block_bit({x, 1, 1})) != 0, x < 2) << x;
        EXPECT_NE(open.reached & block_bit({x, 1, 1}), 0u) << x;
    }
    EXPECT_EQ(open.apart, 0u);
}

TEST(Blocks, WithoutAirAboutItAllThatIsFreeHasToBeConnected) {
    // A wall divides each of the lowest voxels.
    const auto wall = [](int end) {
        return blocks_where([&](const glm::ivec3& b) { return b.z == 1 && b.x < end; });
    };
    EXPECT_FALSE(air_about(wall(12), 0).one);
    EXPECT_TRUE(air_about(wall(11), 0).one);
}

TEST(Blocks, OpeningsAreConnectedUnlessAWallIsBetweenThem) {
    std::array<uint64_t, 27> blocks{}, wanted{};
    wanted[13] = wanted[4] = wanted[22] = kAllBlocks;
    EXPECT_TRUE(connects(blocks, wanted));
    for (int i = 9; i < 18; ++i) blocks[i] = 0xffffu << 16;
    wanted[13] = 0xffff;
    EXPECT_FALSE(connects(blocks, wanted));
    wanted[22] = 0;
    EXPECT_TRUE(connects(blocks, wanted));
    wanted[13] = 0;
    EXPECT_FALSE(connects(blocks, wanted)) << "nothing is wanted in the middle";
}

TEST(Air, VoxelsOfAClosedWallLetNothingPassAndThoseAtAnOpeningTheirShare) {
    std::vector<FlatSurfel> wall = flat::square(120, 1);
    const Grid grid = grid_about(wall, 16);
    const Voxels closed = divided(wall, grid);
    const Air nothing(closed, wall);
    // At the rim of the square there is no wall beside it.
    const auto inner = [](const glm::ivec3& cell) {
        return cell.x > 3 && cell.y > 3 && cell.x < 12 && cell.y < 12;
    };
    for (uint32_t voxel = 0; voxel < closed.occupied().size(); ++voxel)
        if (inner(grid.cell(closed.occupied()[voxel]))) {
            EXPECT_EQ(nothing.passing(voxel), glm::vec3(0));
        }
    std::erase_if(wall, [](const FlatSurfel& s) { return std::abs(s.x - .5f) < .04f; });
    const Voxels open = divided(wall, grid);
    const Air air(open, wall);
    const glm::ivec3 beside(grid.place({.49f, .5f, 0}));
    ASSERT_FALSE(open.is_air(beside));
    const glm::vec3 passing = air.passing(open.at(beside));
    EXPECT_EQ(passing.z, .5f) << "half of it is open";
    EXPECT_EQ(passing.x, .5f) << "above and below the wall, which lies in the border of two blocks";
}

TEST(Air, SeesNothingThroughASealedRoom) {
    const auto surfels = flat::noisy_room(20000);
    const Voxels voxels = divided(surfels, grid_about(surfels, kVoxels));
    const Air air(voxels, surfels);
    const auto inside = flood(voxels, voxels.grid().size / 2);
    Random random(4);
    std::vector<glm::vec3> in, out;
    for (uint32_t cell = 0; cell < inside.size(); ++cell) {
        if (voxels.numbers()[cell] != Voxels::kAir) continue;
        const glm::vec3 jitter(random.uniform(), random.uniform(), random.uniform());
        (inside[cell] ? in : out).push_back(glm::vec3(voxels.grid().cell(cell)) + jitter);
    }
    ASSERT_GT(in.size(), 1000u);
    ASSERT_GT(out.size(), 100u);
    for (size_t i = 0; i < 20000; ++i) {
        const glm::vec3 &a = in[i % in.size()], &b = in[(i * 7919) % in.size()];
        EXPECT_TRUE(air.sees(a, b));
        EXPECT_FALSE(air.sees(a, out[(i * 104729) % out.size()]));
        EXPECT_FALSE(air.sees(out[(i * 104729) % out.size()], a));
    }
}

TEST(Air, SeesAsMuchThroughAGratingAsItsBarsLeaveOpen) {
    // Bars of .4 voxels, 1.37 voxels apart, in a window of a wall.
    const float voxel = 1.0f / 16, width = .4f * voxel, pitch = 1.37f * voxel;
    auto surfels = flat::square(400, 1);
    const float whole = width + 2 * surfels.front().radius;  // discs stick out
    const auto inner = [](float x) { return x > .2f && x < .8f; };
    std::erase_if(surfels, [&](const FlatSurfel& s) {
        return inner(s.x) && inner(s.y) && std::fmod(s.x, pitch) > width;
    });
    const Voxels voxels = divided(surfels, Grid{glm::vec3(-.5f), voxel, glm::ivec3(32)});
    const Air air(voxels, surfels);
    Random random(6);
    size_t seen = 0;
    constexpr size_t kLines = 4000;
    for (size_t i = 0; i < kLines; ++i) {
        const glm::vec3 at(.3 + .4 * random.uniform(), .3 + .4 * random.uniform(), 0);
        const glm::vec3 way(random.uniform() - .5, random.uniform() - .5, 1);
        seen += air.sees(voxels.grid().place(at - .4f * way), voxels.grid().place(at + .4f * way)) ? 1 : 0;
    }
    // Slanted lines meet more of bars that are a block thick.
    EXPECT_NEAR(static_cast<double>(seen) / kLines, 1 - whole / pitch, .07);
}

TEST(Air, SkipsFreeVoxelsAndMissesNoOccupiedBlock) {
    const auto surfels = sheet(glm::normalize(glm::vec3(1, 2, .4f)), 1, 60);
    const Voxels voxels = divided(surfels, Grid{glm::vec3(0), 1.0f / 16, glm::ivec3(32)});
    const Air air(voxels, surfels);
    const Openings openings = find_openings(voxels, surfels);
    Random random(5);
    size_t blocked = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto place = [&] {
            return 32.0f * glm::vec3(random.uniform(), random.uniform(), random.uniform());
        };
        const glm::vec3 from = place(), to = place();
        bool free = true;
        for (int k = 0; k <= 4000; ++k) {
            const glm::vec3 at = glm::mix(from, to, static_cast<float>(k) / 4000);
            const uint32_t voxel = voxels.at(glm::ivec3(at));
            const glm::ivec3 block(glm::fract(at) * float{kBlocksAlong});
            free &= voxel == Voxels::kAir || (openings.blocks[voxel] & block_bit(block)) == 0;
        }
        // Fine steps may miss a corner that the line cuts, never the other way round.
        EXPECT_TRUE(free || !air.sees(from, to));
        blocked += !free;
    }
    EXPECT_GT(blocked, 100u);
}

TEST(Faces, ShowTheWholeSurfaceOnce) {
    for (const glm::vec3 normal :
         {kZ, glm::normalize(glm::vec3(1, 0, 3)), glm::normalize(glm::vec3(2, 3, 4))}) {
        const auto surfels = sheet(normal, 1, 80);
        const Faces faces = Faces::find(divided(surfels, grid_about(surfels, kVoxels)), surfels);
        double front = 0, back = 0;
        for (const Face& face : faces.all()) {
            if (face.area == 0) continue;
            EXPECT_NEAR(std::abs(glm::dot(face.normal, normal)), 1, 1e-3);
            EXPECT_NEAR(glm::dot(face.position - glm::vec3(1), normal), 0, 1e-3);
            (glm::dot(face.normal, normal) > 0 ? front : back) += face.area;
        }
        EXPECT_NEAR(front, 1, .03);
        EXPECT_NEAR(back, 1, .03);
    }
}

TEST(Faces, OfAThinWallShowTheSheetOnTheirSide) {
    // Two sheets of a wall, .4 voxels apart: each faces away from the other.
    std::vector<Surfel> surfels;
    const float gap = .4f / 29;
    scenes::add_rectangle(surfels, kO, kX, kY, 90, glm::vec3(.8f));
    scenes::add_rectangle(surfels, -gap * kZ, kY, kX, 90, glm::vec3(.2f));
    const auto flat = flat::of(surfels);
    const Faces faces = Faces::find(divided(flat, grid_about(flat, kVoxels)), flat);
    const auto upper =
        faces.means<float>([&](uint32_t s, bool) { return surfels[s].albedo.x > .5f ? 1.0f : 0.0f; });
    for (uint32_t face = 0; face < faces.all().size(); ++face) {
        if (axis_of(faces.all()[face].side) != 2) continue;
        EXPECT_NEAR(upper[face], sign_of(faces.all()[face].side) > 0 ? 1 : 0, 1e-5) << face;
    }
}

/// Returns what faces above some height send out, m^2, if those upper sides of a floor at z = 0 have radiance
/// 1 for which lit(position) is true. `lit_area`: of these.
template <class Lit>
double sent_above(const std::vector<Surfel>& surfels, float height, const Lit& lit, double& lit_area) {
    const auto flat = flat::of(surfels);
    const Faces faces = Faces::find(divided(flat, grid_about(flat, kVoxels)), flat);
    const auto radiance = faces.radiance_of<float>([&](uint32_t s, bool back) {
        return !back && surfels[s].position.z == 0 && lit(surfels[s].position) ? 1.0f : 0.0f;
    });
    double sent = 0;
    for (uint32_t i = 0; i < faces.all().size(); ++i)
        if (faces.all()[i].position.z > height) sent += radiance[i] * faces.all()[i].area;
    lit_area = 0;
    for (const Surfel& s : surfels) lit_area += s.position.z == 0 && lit(s.position) ? s.area : 0;
    return sent;
}

TEST(Faces, SendOutTheLightOfWhatLiesBelowGratings) {
    // Bars half a voxel above the floor hide a third of it: what is lit between them sends its light out.
    const float voxel = 1.0f / 29;
    std::vector<Surfel> surfels, bars;
    scenes::add_rectangle(surfels, kO, kX, kY, 120, glm::vec3(.5f));
    scenes::add_rectangle(bars, .5f * voxel * kZ, kX, kY, 240, glm::vec3(.5f));
    for (const Surfel& bar : bars)
        if (std::fmod(bar.position.x, 3 * voxel) < voxel) surfels.push_back(bar);
    const auto between = [&](const glm::vec3& at) {
        const float place = std::fmod(at.x, 3 * voxel);
        return place > 1.2f * voxel && place < 2.8f * voxel;
    };
    double lit = 0;
    const double sent = sent_above(surfels, -1, between, lit);
    EXPECT_NEAR(sent / lit, 1, .05);
}

TEST(Faces, SendOutNothingOfWhatLiesBelowASheet) {
    // In the same voxel as the sheet, and in the next ones below it.
    for (const float gap : {.6f, .9f, 1.2f, 1.6f}) {
        std::vector<Surfel> surfels;
        scenes::add_rectangle(surfels, kO, kX, kY, 120, glm::vec3(.5f));
        scenes::add_rectangle(surfels, gap / 29 * kZ, kX, kY, 120, glm::vec3(.5f));
        const auto inner = [](const glm::vec3& at) {
            return std::max(std::abs(at.x - .5f), std::abs(at.y - .5f)) < .35f;
        };
        double lit = 0;
        EXPECT_EQ(sent_above(surfels, .5f * gap / 29, inner, lit), 0) << gap;
        EXPECT_GT(lit, .4);
    }
}

TEST(Faces, OfASealedRoomShowNothingThatIsLitFromOutside) {
    const auto surfels = flat::noisy_room(20000);
    const Voxels voxels = divided(surfels, grid_about(surfels, kVoxels));
    const Faces faces = Faces::find(voxels, surfels);
    const auto inside = flood(voxels, voxels.grid().size / 2);
    const auto backs = faces.means<float>([](uint32_t, bool back) { return back ? 1.0f : 0.0f; });
    size_t inner = 0;
    for (uint32_t face = 0; face < faces.all().size(); ++face) {
        const Face& f = faces.all()[face];
        const glm::ivec3 air = voxels.grid().cell(voxels.occupied()[f.voxel]) + step_of(f.side);
        if (!voxels.grid().holds(air) || !inside[voxels.grid().number(air)]) continue;
        ++inner;
        EXPECT_EQ(backs[face], 0) << "normals point into the room";
    }
    EXPECT_GT(inner, 3000u);
}

}  // namespace
}  // namespace lucarne::gi::volume
