#include "octree/normals/orientation/orientation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/normals/orientation/signed_forest.h"
#include "tests/octree/normals/normal_clouds.h"

namespace lucarne::octree {
namespace {

using namespace testing;
using Random = lucarne::Random;

double oriented(const char* name, const Cloud& cloud, uint32_t parts, const NormalOptions& options = {}) {
    const Score s = score(cloud, estimate(cloud, options, parts));
    std::printf("%-34s %3u chunks: oriented %.5f, marked %.4f\n", name, parts * parts * parts, s.oriented,
                s.marked);
    return s.oriented;
}

/// Hills of half a unit over a unit square, seen from above.
Cloud wavy_sheet(size_t count) {
    Random random(1);
    Cloud cloud;
    for (size_t i = 0; i < count; ++i) {
        const double x = random.uniform() * 6, y = random.uniform() * 6;
        cloud.points.push_back({x, y, std::sin(2 * x) * std::cos(2 * y)});
        cloud.normals.push_back(glm::normalize(
            glm::dvec3(-2 * std::cos(2 * x) * std::cos(2 * y), 2 * std::sin(2 * x) * std::sin(2 * y), 1)));
    }
    return cloud;
}

/// A torus on its edge. Its top is outside, but half of its surface faces its own centre.
Cloud torus(size_t count) {
    Random random(2);
    Cloud cloud;
    while (cloud.points.size() < count) {
        const double u = random.uniform() * 2 * std::numbers::pi, v = random.uniform() * 2 * std::numbers::pi;
        const double ring = 2 + 0.7 * std::cos(v);
        if (random.uniform() * 2.7 > ring) continue;  // evenly by area
        const glm::dvec3 n(std::cos(u) * std::cos(v), std::sin(v), std::sin(u) * std::cos(v));
        cloud.points.push_back({std::cos(u) * ring, 0.7 * std::sin(v), std::sin(u) * ring});
        cloud.normals.push_back(n);
    }
    return cloud;
}

/// A unit room seen from its middle.
Cloud room(size_t count) {
    Cloud cloud = cube(count);
    for (auto& n : cloud.normals) n = -n;
    return cloud;
}

/// Random groups whose halves agree by many votes; one strong vote between the halves is false.
TEST(Orientation, ManyVotesBetweenTwoHalvesOutdoAStrongFalseOne) {
    constexpr uint32_t kHalf = 200;
    Random random(7);
    for (int round = 0; round < 20; ++round) {
        std::vector<bool> turned(2 * kHalf);
        for (auto&& t : turned) t = random.uniform() < 0.5;
        const auto node = [&](uint32_t half) {
            return half * kHalf + static_cast<uint32_t>(random.uniform() * kHalf);
        };
        SignVotes votes;
        const auto vote = [&](uint32_t a, uint32_t b, bool right, double weight) {
            if (a != b) votes.add(a, b, (turned[a] != turned[b]) == right, weight);
        };
        for (uint32_t half = 0; half < 2; ++half) {
            for (uint32_t i = 1; i < kHalf; ++i)  // a chain, so that the tree is deep
                vote(half * kHalf + i - 1, half * kHalf + i, true, 20 + random.uniform());
            for (uint32_t i = 0; i < 3 * kHalf; ++i)
                vote(node(half), node(half), random.uniform() < 0.9, random.uniform());
        }
        vote(node(0), node(1), false, 10);
        for (int i = 0; i < 30; ++i) vote(node(0), node(1), true, 1);
        SignedForest forest(2 * kHalf);
        votes.unite(forest);
        size_t wrong = 0;
        const auto first = forest.find(0);
        for (uint32_t i = 0; i < 2 * kHalf; ++i) {
            const auto root = forest.find(i);
            ASSERT_EQ(root.node, first.node);
            wrong += (root.opposite != first.opposite) != (turned[i] != turned[0]);
        }
        EXPECT_EQ(wrong, 0u) << round;
    }
}

TEST(Orientation, SignedForestKeepsRelativeSigns) {
    Random random(1);
    constexpr uint32_t kNodes = 2000;
    std::vector<bool> truth(kNodes);
    for (uint32_t i = 0; i < kNodes; ++i) truth[i] = random.next() & 1;
    SignedForest forest(kNodes);
    for (int i = 0; i < 20000; ++i) {
        const auto a = static_cast<uint32_t>(random.next() % kNodes),
                   b = static_cast<uint32_t>(random.next() % kNodes);
        const bool joined = forest.find(a).node == forest.find(b).node;
        EXPECT_EQ(forest.unite(a, b, truth[a] != truth[b]), !joined);
    }
    for (uint32_t i = 0; i < kNodes; ++i) {
        EXPECT_EQ(forest.find(i).node, 0u);
        EXPECT_EQ(forest.find(i).opposite, truth[i] != truth[0]);
    }
}

TEST(Orientation, AgreementFollowsTheSurfaceRoundAnEdge) {
    const glm::vec3 up(0, 0, 1), right(1, 0, 0);
    EXPECT_FALSE(agreement(up, up, {1, 0, 0}).opposite);
    EXPECT_TRUE(agreement(up, -up, {1, 0, 0}).opposite);
    // Over the outer edge of a box, and into the corner of a room.
    const Agreement over = agreement(up, right, {1, 0, -1}), into = agreement(up, right, {-1, 0, 1});
    EXPECT_FALSE(over.opposite);
    EXPECT_LT(over.doubt, 1e-6f);
    EXPECT_FALSE(into.opposite);
    EXPECT_LT(into.doubt, 1e-6f);
    EXPECT_EQ(agreement(up, up, {0.1f, 0, 1}).doubt, 1) << "the faces of a thin wall";
}

TEST(Orientation, ClosedSurfacesPointOutwardWithoutStations) {
    Cloud statue = torus(20000);
    append(statue, sphere(5000), {5, 0, 1}, 0.5);
    for (const uint32_t parts : {1u, 2u, 4u}) {
        EXPECT_EQ(oriented("sphere", sphere(10000), parts), 1);
        EXPECT_GT(oriented("noisy sphere", sphere(10000, 0.02), parts), 0.999);
        EXPECT_GT(oriented("torus and sphere", statue, parts), 0.998);
    }
}

TEST(Orientation, RoomsWithFloorAndCeilingAreSeenFromInside) {
    Cloud rooms = room(20000);
    append(rooms, room(20000), {3, 0, 0.5});
    for (const uint32_t parts : {1u, 2u, 4u})
        EXPECT_GT(oriented("two rooms, no stations", rooms, parts), 0.9999);
}

TEST(Orientation, WhatStandsOnTheGroundIsSeenFromOutside) {
    Cloud scene;  // a box without a bottom, in the middle of a square of ground
    for (const Cloud& part : {cube(20000), plane(30000)}) {
        const bool ground = part.points.size() == 30000;
        for (size_t i = 0; i < part.points.size(); ++i) {
            const auto p = ground ? part.points[i] * 3.0 - glm::dvec3(1, 1, 0) : part.points[i];
            const bool under = ground && p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1;
            if (under || (!ground && part.normals[i].z < 0)) continue;
            scene.points.push_back(p);
            scene.normals.push_back(part.normals[i]);
        }
    }
    for (const uint32_t parts : {1u, 3u}) EXPECT_GT(oriented("box on the ground", scene, parts), 0.998);
}

/// Walls that touch a floor below which there are points, too, as in a cloud that a mesh was sampled to:
/// where they meet, the floor outside and the floor inside speak for opposite sides.
TEST(Orientation, BodiesOnAFloorThatGoesOnBelowThemAreSeenFromOutside) {
    Cloud scene = room(60000);
    for (const double x : {0.25, 0.65}) {
        const Cloud body = cube(20000, 0, 3);
        for (size_t i = 0; i < body.points.size(); ++i) {
            if (body.normals[i].z < 0) continue;
            scene.points.push_back(glm::dvec3(x, 0.4, 0) + body.points[i] * glm::dvec3(0.2, 0.2, x + 0.2));
            scene.normals.push_back(body.normals[i]);
        }
    }
    for (const uint32_t parts : {1u, 2u, 3u}) EXPECT_GT(oriented("bodies in a room", scene, parts), 0.995);
}

/// Both faces of a board are nearer to each other than points of a face that follow each other.
TEST(Orientation, BothFacesOfABoardInARoomAreSeenFromOutside) {
    Cloud scene = room(60000);
    const Cloud board = cube(20000, 0, 4);
    for (size_t i = 0; i < board.points.size(); ++i) {
        const glm::dvec3 sides(0.5, 0.5, 0.02);
        const double share = board.normals[i].z != 0 ? 0.25 : 0.01;  // evenly by area
        if (static_cast<double>(mix64(i, 5) >> 11) * 0x1.0p-53 > 4 * share) continue;
        scene.points.push_back(glm::dvec3(0.25, 0.25, 0.4) + board.points[i] * sides);
        scene.normals.push_back(board.normals[i]);
    }
    for (const uint32_t parts : {1u, 3u}) EXPECT_GT(oriented("board in a room", scene, parts), 0.99);
}

// Far outliers and a line, over which no ray hits anything.
TEST(Orientation, CloudsWithoutInsideAndOutsideEnd) {
    Cloud far = sphere(20000);
    for (const double x : {1e6, -1e7}) append(far, plane(30), {x, x, x});
    for (const uint32_t parts : {1u, 2u}) EXPECT_GT(oriented("sphere, far outliers", far, parts), 0.99);
    Cloud line;
    for (int i = 0; i < 5000; ++i) line.points.push_back({i * 1e-3, 0, 0}), line.normals.push_back({0, 0, 1});
    oriented("line", line, 1);
}

TEST(Orientation, OpenSheetsPointUpAndHangTogether) {
    for (const uint32_t parts : {1u, 3u, 5u})
        EXPECT_GT(oriented("wavy sheet", wavy_sheet(20000), parts), 0.9999);
}

TEST(Orientation, PointsFaceTheStationThatSawThem) {
    Cloud inside = room(20000);
    NormalOptions options;
    options.stations = {{0.4, 0.5, 0.6}};
    inside.stations.assign(inside.points.size(), 0);
    for (const uint32_t parts : {1u, 3u})
        EXPECT_GT(oriented("room, one station", inside, parts, options), 0.9995);

    // Two stations on the two sides of a wall that is thinner than the neighbourhoods. Only the stations tell
    // the sides apart.
    Cloud wall = plane(10000, 0, 1);
    append(wall, plane(10000, 0, 2), {0, 0, -0.02});
    options.stations = {{0.5, 0.5, 1}, {0.5, 0.5, -1}};
    wall.stations.assign(10000, 0);
    wall.stations.resize(20000, 1);
    for (size_t i = 10000; i < 20000; ++i) wall.normals[i] = -wall.normals[i];
    EXPECT_GT(oriented("thin wall, two stations", wall, 2, options), 0.999);
}

TEST(Orientation, KnownPointsAnchorTheUnknownOnesTheyHangTogetherWith) {
    Cloud inside = room(20000);
    NormalOptions options;
    options.stations = {{0.4, 0.5, 0.6}};
    inside.stations.assign(inside.points.size(), -1);
    for (size_t i = 0; i < inside.points.size(); ++i)
        if (inside.points[i].x > 0.9 && inside.points[i].z < 0.3) inside.stations[i] = 0;
    for (const uint32_t parts : {1u, 2u, 4u})
        EXPECT_GT(oriented("room, one corner known", inside, parts, options), 0.999);
}

TEST(Orientation, StationsThatDoNotExistCountAsUnknown) {
    Cloud cloud = sphere(3000);
    cloud.stations.assign(cloud.points.size(), 7);
    EXPECT_EQ(oriented("sphere, stations that are not there", cloud, 2), 1);
}

}  // namespace
}  // namespace lucarne::octree
