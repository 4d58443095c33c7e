// Discs in the air: whoever is much larger than what is around must lie in its plane.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "octree/normals/surface/earned.h"
#include "tests/octree/normals/surface_truth.h"

namespace lucarne::octree {
namespace {

using namespace testing;

constexpr double kWallSpacing = 0.01;

/// Adds a rectangle of random points, `spacing` apart on average, and returns the first one's index.
size_t add_wall(Cloud& cloud, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v,
                double spacing, Random& random, double noise = 0.001) {
    const size_t first = cloud.points.size();
    const glm::dvec3 n = glm::normalize(glm::cross(u, v));
    const auto count = static_cast<size_t>(glm::length(u) * glm::length(v) / (spacing * spacing));
    for (size_t i = 0; i < count; ++i) {
        const double along = random.uniform(), up = random.uniform();
        cloud.points.push_back(corner + along * u + up * v + noise * gaussian(random) * n);
        cloud.normals.push_back(n);
        cloud.stations.push_back(0);
    }
    return first;
}

/// The widest disc and the sum of the shares of points from `first` on.
struct Drawn {
    double widest = 0, area = 0;
    size_t count = 0;
};
Drawn drawn(const Estimate& found, size_t first, size_t end) {
    Drawn sum;
    for (size_t i = first; i < end; ++i) {
        const double radius = drawn_radius(found, i);
        sum.widest = std::max(sum.widest, radius);
        if (radius > 0) sum.area += found.areas[i], ++sum.count;
    }
    return sum;
}

/// Two walls of different depth with points scattered between them, of which no plane is right.
TEST(Air, PointsScatteredBetweenWallsAreSmall) {
    Random random(11);
    Cloud cloud;
    add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, kWallSpacing, random);
    add_wall(cloud, {0, 0, 0.4}, {1, 0, 0}, {0, 1, 0}, kWallSpacing, random);
    const size_t first = cloud.points.size();
    for (int i = 0; i < 150; ++i)
        cloud.points.emplace_back(0.9 + 0.3 * random.uniform(), random.uniform(),
                                  0.05 + 0.3 * random.uniform());
    cloud.normals.resize(cloud.points.size());
    const Estimate found = estimate(cloud);
    const Drawn air = drawn(found, first, cloud.points.size());
    std::printf("in the air: %zu discs, shares %.3f m2, radius up to %.3f m\n", air.count, air.area,
                air.widest);
    EXPECT_LT(air.widest, 0.12);
    EXPECT_LT(air.area, 0.03);
    EXPECT_NEAR(drawn(found, 0, first).area, 3, 0.06);
}

TEST(Air, SparseWallsBesideDenseFloorsAreWhole) {
    Random random(12);
    Cloud cloud;
    add_wall(cloud, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kWallSpacing, random);
    const size_t wall = add_wall(cloud, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 6 * kWallSpacing, random);
    const Estimate found = estimate(cloud);
    EXPECT_NEAR(drawn(found, wall, cloud.points.size()).area, 1, 0.15);
    // Rays from before the wall, also near the floor, hit its discs.
    const DiscScene discs(cloud, found);
    int through = 0;
    for (int i = 0; i < 2000; ++i) {
        const double x = 0.1 + 0.8 * random.uniform(), z = 0.01 + 0.89 * random.uniform();
        through += !discs.cast(glm::dvec3(x, 0.5, z), {0, 1, 0});
    }
    std::printf("%d of 2000 rays pass the wall\n", through);
    EXPECT_LE(through, 80) << "just above the floor; 186 if the floor's density bounds the wall's discs";
}

/// Below a scanner another one sees the floor sparsely. The points beside the first one's nearest scan line
/// have only this line for neighbours, through which many planes go; they were left out, and the floor had
/// slits there.
TEST(Air, FloorsBelowAScannerHaveNoSlits) {
    constexpr int kSparse = 300;
    Random random(15);
    Cloud cloud;
    const auto add = [&](double radius, double angle) {
        cloud.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                  0.001 * gaussian(random));
    };
    for (double radius = 0.6; radius < 1.2; radius += 0.012)
        for (double angle = 0; angle < 2 * std::numbers::pi; angle += 0.004 / radius) add(radius, angle);
    const size_t first = cloud.points.size();
    for (int i = 0; i < kSparse; ++i)
        add(0.6 * std::sqrt(random.uniform()), 2 * std::numbers::pi * random.uniform());
    cloud.normals.resize(cloud.points.size(), {0, 0, 1});
    cloud.stations.resize(cloud.points.size(), 0);
    const Estimate found = estimate(cloud);
    const Drawn sparse = drawn(found, first, cloud.points.size());
    const DiscScene discs(cloud, found);
    int through = 0;
    for (int i = 0; i < 5000; ++i) {
        const double radius = std::sqrt(random.uniform()), angle = 2 * std::numbers::pi * random.uniform();
        through += !discs.cast(glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 1), {0, 0, -1});
    }
    std::printf("%zu of %d sparse points drawn, %d of 5000 rays pass\n", sparse.count, kSparse, through);
    EXPECT_GE(sparse.count, kSparse * 97u / 100);
    EXPECT_LE(through, 12);
}

/// A pane has few points, in the plane of its wall or behind it. They keep their size: nothing is known
/// better.
TEST(Air, PointsOfAPaneStay) {
    for (const double behind : {0.0, 0.1}) {
        Random random(13);
        Cloud cloud;
        add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, kWallSpacing, random);
        std::erase_if(cloud.points, [](const auto& p) { return glm::length(p - glm::dvec3(1, 1, 0)) < 0.5; });
        cloud.normals.resize(cloud.points.size());
        cloud.stations.resize(cloud.points.size());
        const size_t pane = add_wall(cloud, {0.65, 0.65, -behind}, {0.7, 0, 0}, {0, 0.7, 0}, 0.08, random);
        const Drawn drawn_pane = drawn(estimate(cloud), pane, cloud.points.size());
        EXPECT_GE(drawn_pane.count, (cloud.points.size() - pane) / 2) << behind;
        EXPECT_GT(drawn_pane.area, 0.25) << behind;
    }
}

TEST(Air, RailingsAndWiresBeforeWallsStay) {
    for (const double thick : {0.02, 0.001}) {
        Random random(14);
        Cloud cloud;
        add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, kWallSpacing, random);
        const size_t bars = cloud.points.size();
        for (int i = 0; i < 6000; ++i) {
            const double turn = 2 * std::numbers::pi * random.uniform(),
                         bar = 0.2 * std::floor(10 * random.uniform());
            const glm::dvec3 n(std::cos(turn), 0, std::sin(turn));
            cloud.points.push_back(glm::dvec3(bar, random.uniform(), 0.3) + thick * n);
            cloud.normals.push_back(n);
            cloud.stations.push_back(0);
        }
        const Drawn rail = drawn(estimate(cloud), bars, cloud.points.size());
        EXPECT_GE(rail.count, 6000u * 9 / 10) << thick;
        EXPECT_LT(rail.widest, 0.05) << thick;
    }
}

/// Of a wire with hardly more than one point after the other, some plane through these is stable. Their discs
/// reach to the third point at most: 2.3 to 3.0 steps wide for these and other wires, 6.1 to 8.8 if their
/// cells were their shares. The points are drawn one coordinate after the other, so that every compiler tests
/// the same wires.
TEST(Air, WiresOfSinglePointsAreThin) {
    constexpr double kStep = 0.012, kScatter = 0.003;
    for (uint64_t seed = 0; seed < 4; ++seed) {
        Random random(seed);
        Cloud cloud;
        add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, 1, 0}, kWallSpacing / 2, random);
        const size_t wire = cloud.points.size();
        for (double x = 0.2; x < 1.8; x += kStep) {
            const double up = kScatter * gaussian(random), out = 0.3 * kScatter * gaussian(random);
            cloud.points.emplace_back(x, 0.5 + up, 0.4 + out);
        }
        cloud.normals.resize(cloud.points.size());
        cloud.stations.resize(cloud.points.size());
        const Estimate found = estimate(cloud);
        const Drawn discs = drawn(found, wire, cloud.points.size());
        std::printf("wire %zu: %zu of %zu discs, radius up to %.3f m\n", static_cast<size_t>(seed),
                    discs.count, cloud.points.size() - wire, discs.widest);
        EXPECT_GE(discs.count, (cloud.points.size() - wire) * 9 / 10) << seed;
        EXPECT_LT(discs.widest, 4 * kStep) << seed;
    }
}

TEST(Air, ADiscInACrowdMustLieInItsPlane) {
    Random random(15);
    // Of a disc of radius 1 in the plane z = 0 among points of planes that are tilted against it.
    const auto earned = [&](size_t points, const std::vector<double>& tilts, bool sparse = false,
                            bool doubtful = false) {
        Tile tile;
        for (size_t i = 0; i < points; ++i) {
            const double a = 4 * random.uniform() - 2, b = 4 * random.uniform() - 2,
                         tilt = tilts[i % tilts.size()];
            tile.x.push_back(static_cast<float>(a));
            tile.y.push_back(static_cast<float>(b * std::cos(tilt)));
            tile.z.push_back(static_cast<float>(b * std::sin(tilt)));
        }
        tile.count = points;
        return earned_area(tile, glm::vec3(0.0f), kEarnedLook, {{0, 0, 1}, 1, sparse, doubtful});
    };
    EXPECT_TRUE(std::isinf(earned(2000, {0})));
    EXPECT_TRUE(std::isinf(earned(2000, {0, 1.5}))) << "where two walls meet";
    EXPECT_TRUE(std::isinf(earned(60, {1}))) << "no crowd";
    EXPECT_TRUE(std::isinf(earned(60, {0, 1}, true))) << "no crowd, and half of the points lie in the plane";
    EXPECT_TRUE(std::isinf(earned(0, {1})));
    EXPECT_TRUE(std::isinf(earned(8, {1}, true))) << "a few points say nothing";
    // The points have 16 square units of their plane.
    EXPECT_NEAR(earned(2000, {1}), 16.0 / 2000, 1e-3);
    EXPECT_LT(earned(2000, {1}, true), 4.0 / 2000) << "sparse: half-way to the nearest";
    EXPECT_LT(earned(80, {1.5}, true), .5) << "scattered: the disc ends before the nearest point";
    // 36 points would be a sheet.
    EXPECT_TRUE(std::isinf(earned(100, {0, 1, 1}, false, false)));
    EXPECT_LT(earned(100, {0, 1, 1}, false, true), .5) << "doubtful, and most points lie elsewhere";
    EXPECT_TRUE(std::isinf(earned(100, {0, 0, 0, 1}, false, true))) << "most lie in the plane";
    EXPECT_TRUE(std::isinf(earned(30, {0, 1, 1}, false, true))) << "no more than a sheet";
}

TEST(Air, APointWithoutASurfaceReachesToTheNearest) {
    EXPECT_NEAR(surfel_radius(lone_area(.04f), 0), .2, 1e-3);
}

/// Groups of some points that hang around a cord below a dense ceiling have some plane through them.
TEST(Air, GroupsAroundACordAreDots) {
    Random random(18);
    Cloud cloud;
    add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, kWallSpacing, random);
    const size_t first = cloud.points.size();
    for (int group = 0; group < 60; ++group) {
        const glm::dvec3 middle(.8 + .4 * random.uniform(), .8 + .4 * random.uniform(),
                                .08 + .3 * random.uniform());
        for (int i = 0; i < 3; ++i)
            cloud.points.push_back(middle +
                                   .02 * glm::dvec3(random.uniform(), random.uniform(), random.uniform()));
    }
    cloud.normals.resize(cloud.points.size());
    cloud.stations.resize(cloud.points.size());
    const Estimate found = estimate(cloud);
    const Drawn air = drawn(found, first, cloud.points.size());
    std::printf("around the cord: %zu discs, shares %.4f m2, radius up to %.3f m\n", air.count, air.area,
                air.widest);
    EXPECT_LT(air.area, .045) << "it is .08 if sparse groups need not earn their size";
    EXPECT_NEAR(drawn(found, 0, first).area, 4, .08);
}

/// A cable 2 cm thick before a wall, and the curtain of mixed pixels behind both of its outlines, ever
/// sparser. No station is known.
TEST(Air, CurtainsBehindACableAreDots) {
    constexpr double kRadius = 0.01, kLength = 1.2, kDepth = 0.15;
    const glm::dvec3 back = glm::normalize(glm::dvec3(1, 0, -1)),
                     across = glm::normalize(glm::dvec3(1, 0, 1));
    size_t wide = 0;  // discs
    for (uint64_t seed = 30; seed < 38; ++seed) {
        Random random(seed);
        Cloud cloud;
        add_wall(cloud, {0, 0, 0}, {2, 0, 0}, {0, kLength, 0}, kWallSpacing, random);
        // Numbers are drawn one after the other, so that every compiler tests the same points.
        const auto add = [&](double deep, double right) {
            const double along = random.uniform();
            cloud.points.push_back(glm::dvec3(1, kLength * along, 0.5) + deep * back + right * across);
        };
        for (size_t i = 0; i < 750; ++i) {
            const double angle = 2 * std::numbers::pi * random.uniform();
            add(kRadius * std::cos(angle), kRadius * std::sin(angle));
        }
        const size_t curtain = cloud.points.size();
        for (int i = 0; i < 84; ++i) {
            const double side = random.uniform() < 0.5 ? -kRadius : kRadius;
            const double noise = 0.002 * gaussian(random);
            add(kDepth * std::pow(random.uniform(), 2), side + noise);
        }
        cloud.normals.resize(cloud.points.size());
        cloud.stations.resize(cloud.points.size());
        const Estimate found = estimate(cloud);
        const Drawn air = drawn(found, curtain, cloud.points.size());
        std::printf("curtain %zu: %.2f of its area, radius up to %.3f m\n", static_cast<size_t>(seed),
                    air.area / (kDepth * kLength), air.widest);
        for (size_t i = curtain; i < cloud.points.size(); ++i) wide += drawn_radius(found, i) > 0.03;
        EXPECT_NEAR(drawn(found, 0, curtain).area, 2 * (1 + std::numbers::pi * kRadius) * kLength, 0.05)
            << seed;
    }
    std::printf("curtains: %zu of %d discs over 3 cm\n", wide, 8 * 84);
    EXPECT_LE(wide, 32u) << "they are 45 if doubtful discs need not earn more, 23 now";
}

/// A sparse reveal between two dense walls, as one sees of a window at a low angle, has a plane that is as
/// certain as theirs. Within two of its spacings of the walls it is taken for mixed pixels in part.
TEST(Air, SparseRevealsStayClosed) {
    Random random(34);
    Cloud cloud;
    add_wall(cloud, {0, 0, 0}, {1, 0, 0}, {0, 1.2, 0}, kWallSpacing, random);
    add_wall(cloud, {1, 0, -0.5}, {1, 0, 0}, {0, 1.2, 0}, kWallSpacing, random);
    const size_t reveal = cloud.points.size();
    add_wall(cloud, {1, 0, -0.5}, {0, 0, 0.5}, {0, 1.2, 0}, 0.03, random, 0.002);
    cloud.normals.resize(cloud.points.size());
    cloud.stations.resize(cloud.points.size());
    const Estimate found = estimate(cloud);
    double area = 0;
    for (size_t i = reveal; i < cloud.points.size(); ++i)
        if (std::abs(cloud.points[i].z + 0.25) < 0.15) area += found.areas[i];
    std::printf("reveal: %.2f of its middle\n", area / (0.3 * 1.2));
    EXPECT_GT(area, 0.9 * 0.3 * 1.2);
}

/// What a scanner saw of somebody who passed, or of another scanner. The points have a plane and are each
/// other's neighbours.
TEST(Air, SmallGroupsFarFromAllElseAreLeftOut) {
    Random random(21);
    Cloud cloud;
    for (const double z : {0.0, 2.4}) add_wall(cloud, {0, 0, z}, {4, 0, 0}, {0, 2, 0}, 0.02, random);
    const size_t ghost = add_wall(cloud, {2, 1.5, 1}, {0.2, 0, 0}, {0, 0, 0.35}, 0.05, random);
    const size_t board = add_wall(cloud, {3.6, 0.4, 0.8}, {0, 1, 0}, {0, 0, 0.4}, 0.04, random);
    ASSERT_GT(board - ghost, 24u);
    // A crown of leaves: each is nearer to the others than two times its size.
    const size_t leaves = cloud.points.size();
    for (int leaf = 0; leaf < 120; ++leaf) {
        const double x = random.uniform(), y = random.uniform(), z = random.uniform();
        const glm::dvec3 middle(0.1 + 0.5 * x, 0.1 + 0.5 * y, 0.8 + 0.5 * z);
        const double turn = 2 * std::numbers::pi * random.uniform();
        const glm::dvec3 side(0.08 * std::cos(turn), 0.08 * std::sin(turn), 0);
        for (int i = 0; i < 20; ++i) {
            const double along = random.uniform(), up = random.uniform();
            cloud.points.push_back(middle + along * side + glm::dvec3(0, 0, 0.08 * up));
        }
    }
    cloud.normals.resize(cloud.points.size());
    cloud.stations.resize(cloud.points.size());
    for (const uint32_t chunks : {1u, 2u}) {
        const Estimate found = estimate(cloud, {}, chunks);
        const auto left_out = [&](size_t first, size_t end) {
            return std::count(found.areas.begin() + static_cast<ptrdiff_t>(first),
                              found.areas.begin() + static_cast<ptrdiff_t>(end), kStrayArea);
        };
        EXPECT_EQ(static_cast<size_t>(left_out(ghost, board)), board - ghost) << chunks;
        EXPECT_EQ(left_out(board, leaves), 0) << chunks;
        EXPECT_LE(left_out(leaves, cloud.points.size()), 24) << chunks << ": of 2400 points of leaves";
        EXPECT_LE(left_out(0, ghost), 3) << chunks;
    }
}

/// With little memory the halo of a chunk ends before the neighbours of a point in the middle of a room.
TEST(Air, LonePointsAreOutliersWhereNotAllNeighboursAreKnown) {
    Random random(19);
    Cloud cloud;
    const glm::dvec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
    for (const auto& corner : {glm::dvec3(0), glm::dvec3(0, 0, 2)})
        add_wall(cloud, corner, x, y, 0.02, random);
    for (const auto& corner : {glm::dvec3(0), glm::dvec3(0, 2, 0)})
        add_wall(cloud, corner, x, z, 0.02, random);
    for (const auto& corner : {glm::dvec3(0), glm::dvec3(2, 0, 0)})
        add_wall(cloud, corner, y, z, 0.02, random);
    const size_t first = cloud.points.size();
    for (int i = 0; i < 8; ++i) cloud.points.push_back(0.77 + 0.5 * glm::dvec3(i & 1, i >> 1 & 1, i >> 2));
    cloud.normals.resize(cloud.points.size());
    cloud.stations.resize(cloud.points.size());
    NormalOptions options;
    options.memory = 1 << 20;
    const Estimate found = estimate(cloud, options, 2);
    for (size_t i = first; i < cloud.points.size(); ++i) EXPECT_EQ(found.areas[i], kStrayArea) << i - first;
    size_t lost = 0;
    for (size_t i = 0; i < first; ++i) lost += found.areas[i] == kStrayArea;
    EXPECT_LE(lost, 3u) << "of the walls";
}

/// The far side of a column, of which other stations saw a strip of sparse points. The plane of those that
/// are around one of the last is that of the strip's middle, so discs stuck out of the column's outline.
TEST(Air, DiscsAtTheSparseRimOfAColumnStayOnIt) {
    Random random(20);
    Cloud column;
    constexpr double kRadius = 0.45, kHeight = 3, kDense = 1.0, kEnd = 1.9, kSparseSpacing = 0.075;
    const auto add_strip = [&](double from, double to, double spacing) {
        const auto count = static_cast<size_t>((to - from) * kRadius * kHeight / (spacing * spacing));
        for (size_t i = 0; i < count; ++i) {
            const double angle = from + (to - from) * random.uniform();
            const glm::dvec3 n(std::cos(angle), std::sin(angle), 0);
            const double off = 0.002 * gaussian(random);
            column.points.push_back((kRadius + off) * n + glm::dvec3(0, 0, kHeight * random.uniform()));
            column.normals.push_back(n);
        }
    };
    add_strip(-1, kDense, kWallSpacing);
    const size_t first = column.points.size();
    add_strip(kDense, kEnd, kSparseSpacing);
    const Estimate found = estimate(column);
    std::vector<double> bent, away;  // degrees; how far discs reach over the column, along its outline
    for (size_t i = first; i < column.points.size(); ++i) {
        const double angle = std::atan2(column.points[i].y, column.points[i].x);
        if (angle < kEnd - 0.2 || std::abs(column.points[i].z - kHeight / 2) > kHeight / 2 - 0.2) continue;
        const double radius = drawn_radius(found, i);
        if (found.normals[i] == glm::vec3(0.0f) || !(radius > 0)) continue;
        const glm::dvec3 n(found.normals[i]), &truth = column.normals[i];
        bent.push_back(std::acos(std::min(1.0, std::abs(glm::dot(n, truth)))) * 180 / std::numbers::pi);
        away.push_back(radius * std::sqrt(std::max(0.0, 1 - glm::dot(n, truth) * glm::dot(n, truth))));
    }
    std::sort(bent.begin(), bent.end());
    std::sort(away.begin(), away.end());
    ASSERT_GT(bent.size(), 20u);
    const size_t middle = bent.size() / 2, most = bent.size() * 9 / 10;
    std::printf(
        "%zu discs: normals off by %.1f, %.1f degrees (p50, p90), rims over the column %.3f, %.3f m\n",
        bent.size(), bent[middle], bent[most], away[middle], away[most]);
    EXPECT_LT(bent[middle], 8.5) << "10.5 with the plane of the points around";
    EXPECT_LT(away[middle], 0.009) << "it was .012";
}

/// Every share of hostile clouds is finite, and no disc is wider than the cloud.
TEST(Air, HostileCloudsAreDefined) {
    Random random(16);
    Cloud pile, pair, noise, strays;
    pile.points.assign(5000, glm::dvec3(1, 2, 3));
    pair.points = {{0, 0, 0}};
    const auto place = [&] { return glm::dvec3(random.uniform(), random.uniform(), random.uniform()); };
    for (int i = 0; i < 5000; ++i) noise.points.push_back(place());
    for (int i = 0; i < 20000; ++i) strays.points.push_back(i < 2000 ? 0.1 * place() : 10.0 * place());
    // A tree: each twig carries three of .4 times its length.
    Cloud tree;
    const auto grow = [&](const auto& self, const glm::dvec3& from, const glm::dvec3& to, int depth) -> void {
        for (int i = 0; i < 40; ++i) tree.points.push_back(glm::mix(from, to, random.uniform()));
        for (int twig = 0; twig < 3 && depth > 0; ++twig)
            self(self, to, to + 0.4 * glm::length(to - from) * glm::normalize(place() - 0.5), depth - 1);
    };
    grow(grow, glm::dvec3(0.0), glm::dvec3(0, 0, 1), 5);
    for (Cloud* cloud : {&pile, &pair, &noise, &strays, &tree}) {
        cloud->normals.resize(cloud->points.size());
        const Estimate found = estimate(*cloud);
        glm::dvec3 low(INFINITY), high(-INFINITY);
        for (const auto& p : cloud->points) low = glm::min(low, p), high = glm::max(high, p);
        for (size_t i = 0; i < cloud->points.size(); ++i) {
            ASSERT_TRUE(std::isfinite(found.areas[i]) && found.areas[i] >= 0);
            ASSERT_LE(drawn_radius(found, i), glm::length(high - low));
        }
    }
}

}  // namespace
}  // namespace lucarne::octree
