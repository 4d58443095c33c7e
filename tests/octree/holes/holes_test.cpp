#include "octree/holes/holes.h"

#include <chrono>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/octree/holes/hole_truth.h"
#include "tests/octree/holes/room_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;

const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// The room of the tests: 6 x 5 x 3 m. Walls 0 to 5 are floor, ceiling, and x = 0, x = 6, y = 0, y = 5.
std::vector<Wall> room() {
    std::vector<Wall> walls;
    add_box(walls, glm::vec3(0), {6, 5, 3}, true);
    return walls;
}

/// Replaces the wall x = 6 by four around an opening.
void open_wall(std::vector<Wall>& walls, float y0, float y1, float z0, float z1) {
    walls[3] = {{6, 0, 0}, 3.0f * kZ, y0 * kY};
    walls.push_back({{6, y1, 0}, 3.0f * kZ, (5 - y1) * kY});
    walls.push_back({{6, y0, z1}, (3 - z1) * kZ, (y1 - y0) * kY});
    if (z0 > 0) walls.push_back({{6, y0, 0}, z0 * kZ, (y1 - y0) * kY});
}

ptrdiff_t count(const std::vector<FillPoint>& points, const std::function<bool(const FillPoint&)>& which) {
    return std::count_if(points.begin(), points.end(), which);
}

/// Even points on a rectangle of the plane z = 0, without those in `missing`; no station is known.
HoleSample floor_without(float side, const std::function<bool(const glm::vec2&)>& missing) {
    HoleSample sample;
    Random random(1);
    constexpr float kSpacing = 0.02f;
    for (float x = 0; x < side; x += kSpacing)
        for (float y = 0; y < side; y += kSpacing) {
            const glm::vec2 at(x + kSpacing * random.uniform(), y + kSpacing * random.uniform());
            if (!missing(at))
                sample.points.push_back({.position = {at, 0},
                                         .normal = kZ,
                                         .colour = {at.x / side, 0.5f, 0.25f},
                                         .area = kSpacing * kSpacing});
        }
    return sample;
}

TEST(Holes, TheDiscBelowATripodIsFilled) {
    const std::vector<Wall> walls = room();
    const std::vector<glm::vec3> stations{{2, 2, 1.7f}};
    const auto points = fill_points(scan_walls(walls, stations));
    ASSERT_FALSE(points.empty());
    const float expected = unseen_area(walls, stations, 0);
    EXPECT_GT(expected, 3);
    EXPECT_NEAR(filled_area(points), expected, 0.05 * expected);
    EXPECT_EQ(count(points,
                    [&](const FillPoint& point) {
                        const float away = glm::length(glm::vec2(point.position) - glm::vec2(stations[0]));
                        return std::abs(point.position.z) > 0.01f || away > 1.7f * 0.62f + 0.1f ||
                               point.normal.z < 0.99f || point.colour.x > 0.01f;  // the floor is black
                    }),
              0);
}

/// A camera beside the scanner did not see the outermost points.
TEST(Holes, BlackPointsAtTheRimDoNotDarkenTheFilling) {
    const auto away = [](const glm::vec2& at) { return glm::length(at - glm::vec2(2.5f)); };
    HoleSample sample = floor_without(5, [&](const glm::vec2& at) { return away(at) < 0.8f; });
    for (HolePoint& point : sample.points)
        point.colour = away(glm::vec2(point.position)) < 0.82f ? glm::vec3(0) : glm::vec3(0.5f);
    const auto points = fill_points(sample);
    ASSERT_FALSE(points.empty());
    for (const FillPoint& point : points) ASSERT_NEAR(point.colour.x, 0.5f, 0.05f);
}

/// The block's shadow covers floor and wall up to their corner, where no points are.
TEST(Holes, ACornerInAShadowIsFilled) {
    std::vector<Wall> walls = room();
    add_box(walls, {4.8f, 2, 0}, {5.3f, 3, 1.2f}, false);
    const std::vector<glm::vec3> stations{{1.5f, 2.5f, 1.6f}, {2, 0.8f, 1.6f}};
    const auto points = fill_points(scan_walls(walls, stations));
    float on_floor = 0, on_wall = 0;
    int off = 0;
    for (const FillPoint& point : points) {
        if (distance_to(walls, point.position) > 0.02f) {
            ++off;
            std::printf("%g %g %g, n %g %g %g\n", point.position.x, point.position.y, point.position.z,
                        point.normal.x, point.normal.y, point.normal.z);
        }
        if (point.position.x > 4 && point.normal.z > 0.9f) on_floor += point.area;
        if (point.normal.x < -0.9f && point.position.x > 5.9f) on_wall += point.area;
    }
    EXPECT_EQ(off, 0);
    const float wall = unseen_area(walls, stations, 3);
    EXPECT_GT(wall, 0.3f);
    EXPECT_NEAR(on_wall, wall, 0.1f * wall);
    // The floor below the block is hidden, too; it may be filled or not.
    const float floor =
        unseen_area(walls, {stations[0] + glm::vec3(0), stations[1]}, 0) - unseen_area(room(), stations, 0);
    EXPECT_GT(floor, 0.8f);
    EXPECT_GT(on_floor, 0.9f * (floor - 0.5f));
    EXPECT_LT(on_floor, 1.1f * floor);
}

TEST(Holes, TheShadowOfARailIsFilledThoughItIsNarrowerThanThreeCells) {
    for (const float thick : {0.07f, 0.08f, 0.1f, 0.12f}) {
        std::vector<Wall> walls = room();
        add_box(walls, {0, 0.5f, 1.1f}, {6, 0.5f + thick, 1.1f + thick}, false);
        const std::vector<glm::vec3> stations{{3, 2.5f, 1.7f}};
        const auto points = fill_points(scan_walls(walls, stations));
        const float expected = unseen_area(walls, stations, 4, 400);
        float filled = 0;
        for (const FillPoint& point : points)
            if (std::abs(point.position.y) < 0.02f) filled += point.area;
        EXPECT_GT(expected, 0.6f);
        EXPECT_NEAR(filled, expected, 0.15f * expected) << thick;
        EXPECT_EQ(count(points, [&](const FillPoint& p) { return distance_to(walls, p.position) > 0.02f; }),
                  0);
    }
}

/// The shadow goes on along the column, so that no plane of it holds more than a part.
TEST(Holes, TheShadowOfARailOnAColumnIsFilledAlongTheColumn) {
    std::vector<Wall> walls = room();
    add_box(walls, {2.5f, 0.1f, 1.2f}, {2.54f, 4.9f, 1.25f}, false);
    const size_t first = walls.size();
    constexpr int kFaces = 48;
    const glm::vec3 foot(3.6f, 2.5f, 0);
    add_column(walls, foot, 0.4f, 2.2f, kFaces);
    const std::vector<glm::vec3> stations{{1.5f, 2.5f, 1.5f}};
    float expected = 0, filled = 0, off = 0;
    for (size_t face = first; face < first + kFaces; ++face) {
        const glm::vec3 n = walls[face].normal();
        // The side that the station sees at more than 25 degrees.
        if (glm::dot(n, glm::normalize(stations[0] - walls[face].corner)) > 0.42f)
            expected += unseen_area(walls, stations, face, 60);
    }
    for (const FillPoint& point : fill_points(scan_walls(walls, stations, 1200))) {
        const float away = glm::length(glm::vec2(point.position - foot));
        if (away > 0.6f || point.position.z < 0.3f || point.position.z > 2.1f) continue;
        (std::abs(away - 0.4f) < 0.015f ? filled : off) += point.area;
    }
    std::printf("%.3f m2 hidden, %.3f filled, %.3f off\n", expected, filled, off);
    EXPECT_GT(filled, 0.9f * expected);
    EXPECT_LT(filled, 2 * expected) << "planes of the column share the hole";
    EXPECT_LT(off, 0.02f * filled);
}

/// A block's shadow on a wall that stands free, and of a pole over the block up to the wall's end. `pole`:
/// how wide it is, m. Returns the filled and the hidden area of the wall.
glm::vec2 shadow_of_a_block(float pole) {
    std::vector<Wall> walls{{{0, 0, 0}, 6.0f * kX, 5.0f * kY}, {{6, 0, 0}, 3.0f * kZ, 5.0f * kY}};
    add_box(walls, {4.8f, 2, 0}, {5.3f, 3, 1.2f}, false);
    add_box(walls, {5, 2.4f, 1.2f}, {5 + pole, 2.4f + pole, 4}, false);
    const std::vector<glm::vec3> stations{{1.5f, 2.5f, 1.6f}};
    glm::vec2 area(0, unseen_area(walls, stations, 1));
    for (const FillPoint& point : fill_points(scan_walls(walls, stations)))
        if (std::abs(point.position.x - 6) < 0.02f) area.x += point.area;
    return area;
}

TEST(Holes, AShadowIsFilledThoughANarrowPartOfItReachesTheEndOfTheWall) {
    for (const float pole : {0.05f, 0.15f, 0.3f}) {
        const glm::vec2 area = shadow_of_a_block(pole);
        EXPECT_GT(area.y, 1.5f);
        EXPECT_NEAR(area.x, area.y, 0.15f * area.y) << pole;
    }
    EXPECT_EQ(shadow_of_a_block(0.9f).x, 0) << "the wall may end there";
}

TEST(Holes, AWindowThatAStationLooksThroughStaysOpen) {
    for (const bool garden : {true, false}) {
        std::vector<Wall> walls = room();
        open_wall(walls, 1.5f, 3, 0.9f, 2.2f);
        if (garden) walls.push_back({{12, -5, -1}, 6.0f * kZ, 15.0f * kY});
        const std::vector<glm::vec3> stations{{2, 2, 1.7f}};
        const auto points = fill_points(scan_walls(walls, stations));
        ASSERT_FALSE(points.empty()) << "the floor below the tripod";
        EXPECT_EQ(count(points, [](const FillPoint& point) { return std::abs(point.position.z) > 0.02f; }), 0)
            << garden;
    }
}

/// Points without a station come to a scan with one. Its station never saw their wall, so the window in it is
/// hidden from all stations that are known.
TEST(Holes, AWindowOfPointsWithoutAStationStaysOpen) {
    const std::vector<glm::vec3> stations{{2, 2, 1.7f}};
    HoleSample sample = scan_walls(room(), stations);
    std::vector<Wall> walls = room();
    open_wall(walls, 1.5f, 3, 1, 2.2f);
    const glm::vec3 away(20, 0, 0);
    for (HolePoint point : scan_walls(walls, stations).points) {
        point.position += away;
        point.station = -1;
        sample.points.push_back(point);
    }
    EXPECT_EQ(count(fill_points(sample),
                    [&](const FillPoint& point) {
                        const glm::vec3 at = point.position - away;
                        return std::abs(at.x - 6) < 0.1f && at.z > 1.1f && at.z < 2.1f;
                    }),
              0);
}

/// Through the door one sees the floor of the next room, but not the floor behind the wall beside it.
TEST(Holes, ADoorStaysOpen) {
    std::vector<Wall> walls = room();
    open_wall(walls, 2, 3, 0, 2.1f);
    add_box(walls, {6.2f, 0, 0}, {10, 5, 3}, true);
    open_wall(walls, 2, 3, 0, 2.1f);
    walls[8 + 2] = {{6.2f, 0, 0}, 2.0f * kY, 3.0f * kZ};
    walls.push_back({{6.2f, 3, 0}, 2.0f * kY, 3.0f * kZ});
    walls.push_back({{6.2f, 2, 2.1f}, kY, 0.9f * kZ});
    const auto points = fill_points(scan_walls(walls, {{2, 2, 1.7f}, {8, 3, 1.6f}}));
    ASSERT_FALSE(points.empty());
    EXPECT_EQ(count(points,
                    [](const FillPoint& point) {
                        return point.position.x > 5.9f && point.position.x < 6.3f &&
                               point.position.y > 2.1f && point.position.y < 2.9f &&
                               point.position.z > 0.1f && point.position.z < 2;
                    }),
              0);
}

TEST(Holes, TheBorderOfATerrainIsNoHole) {
    const std::vector<Wall> walls{{{-10, -10, 0}, 20.0f * kX, 20.0f * kY}};
    const std::vector<glm::vec3> stations{{1, 0, 1.7f}};
    const auto points = fill_points(scan_walls(walls, stations));
    const float expected = unseen_area({{{-1, -2, 0}, 4.0f * kX, 4.0f * kY}}, stations, 0);
    EXPECT_NEAR(filled_area(points), expected, 0.08f * expected);  // cells of 7 cm
}

TEST(Holes, WithoutStationsOnlySmallHolesOfFloorsAreFilled) {
    const glm::vec2 centre(4, 4);
    const auto disc = [&](float radius) {
        return [=](const glm::vec2& at) { return glm::length(at - centre) < radius; };
    };
    const HoleSample sample = floor_without(8, disc(0.7f));
    const auto points = fill_points(sample);
    EXPECT_NEAR(filled_area(points), 0.7f * 0.7f * std::numbers::pi_v<float>, 0.1f);
    EXPECT_EQ(count(points,
                    [&](const FillPoint& point) {
                        return glm::length(glm::vec2(point.position) - centre) > 0.77f ||
                               std::abs(point.colour.x - 0.5f) > 0.1f ||
                               std::abs(point.colour.z - 0.25f) > 0.01f;
                    }),
              0);
    EXPECT_FALSE(fill_points(floor_without(8, disc(1.3f))).empty()) << "below a tripod";
    EXPECT_TRUE(fill_points(floor_without(8, disc(2.2f))).empty()) << "too large";
    const auto hatch = [&](const glm::vec2& at) {
        return std::abs(at.x - 4) < 0.9f && std::abs(at.y - 4) < 0.9f;
    };
    EXPECT_TRUE(fill_points(floor_without(8, hatch)).empty()) << "2.5 m across, and not round";
    // Without stations normals may face the wrong side; points above tell that this is a floor.
    HoleSample flipped = sample;
    for (HolePoint& point : flipped.points) point.normal = -kZ;
    flipped.points.push_back({.position = {1, 1, 2}, .normal = -kZ, .area = 4e-4f});
    EXPECT_NEAR(filled_area(fill_points(flipped)), filled_area(points), 0.01f);
    // A pit: something is seen below.
    HoleSample pit = sample;
    pit.points.push_back({.position = {4, 4, -0.5f}, .normal = kZ, .area = 4e-4f});
    EXPECT_TRUE(fill_points(pit).empty());
    // The same hole in a wall may be a window.
    HoleSample wall = sample;
    for (HolePoint& point : wall.points) {
        std::swap(point.position.y, point.position.z);
        point.normal = -kY;
    }
    EXPECT_TRUE(fill_points(wall).empty());
    // A small hole of a wall is filled, unless something is seen through it, from whichever side.
    for (const float seen_at : {0.0f, -0.6f, 0.6f}) {
        HoleSample small = floor_without(8, disc(0.13f));
        for (HolePoint& point : small.points) {
            std::swap(point.position.y, point.position.z);
            point.normal = -kY;
        }
        if (seen_at != 0)
            for (int i = 0; i < 400; ++i)
                small.points.push_back({.position = {3.5f + 0.05f * static_cast<float>(i % 20), seen_at,
                                                     3.5f + 0.05f * static_cast<float>(i / 20)},
                                        .normal = -kY,
                                        .area = 25e-4f});
        EXPECT_EQ(fill_points(small).empty(), seen_at != 0) << seen_at;
    }
    // A bay of the border.
    EXPECT_TRUE(fill_points(floor_without(8, [](const glm::vec2& at) {
                    return at.x < 0.9f && std::abs(at.y - 4) < 0.5f;
                })).empty());
}

/// A tripod beside a wall hides a part of the wall, too.
TEST(Holes, WithoutStationsWallsAreFilledBelowTripods) {
    const std::vector<Wall> walls = room();
    const std::vector<glm::vec3> stations{{5.1f, 2.5f, 1.7f}};
    HoleSample sample = scan_walls(walls, stations);
    sample.stations.clear();
    for (HolePoint& point : sample.points) point.station = -1;
    const auto on_wall = [](const FillPoint& point) {
        return std::abs(point.position.x - 6) < 0.02f && point.position.z > 0.02f;
    };
    const auto area = [&](const std::vector<FillPoint>& points) {
        float sum = 0;
        for (const FillPoint& point : points) sum += on_wall(point) ? point.area : 0.0f;
        return sum;
    };
    const float expected = unseen_area(walls, stations, 3);
    EXPECT_GT(expected, 0.1f);
    const auto points = fill_points(sample);
    EXPECT_NEAR(area(points), expected, 0.2f * expected);
    EXPECT_NEAR(filled_area(points), expected + unseen_area(walls, stations, 0), 0.15f);
    EXPECT_EQ(count(points, [&](const FillPoint& p) { return distance_to(walls, p.position) > 0.02f; }), 0);
    // Something before the wall, such as a pipe, does not keep it open. Something behind it does.
    for (const float x : {5.6f, 6.5f}) {
        HoleSample more = sample;
        for (int i = 0; i < 400; ++i)
            more.points.push_back({.position = {x, 2.5f + 0.02f * static_cast<float>(i % 20 - 10),
                                                0.3f * static_cast<float>(i / 20) / 20},
                                   .normal = -kX,
                                   .area = 4e-4f});
        EXPECT_EQ(area(fill_points(more)) > 0, x < 6) << x;
    }
    // A hole as large elsewhere may be a window.
    HoleSample window = sample;
    std::erase_if(window.points, [](const HolePoint& p) {
        return p.position.x < 0.1f && std::abs(p.position.y - 2.5f) < 0.5f && p.position.z < 0.5f;
    });
    EXPECT_EQ(count(fill_points(window),
                    [](const FillPoint& p) { return p.position.x < 0.02f && p.position.z > 0.05f; }),
              0);
}

/// No input takes more than a few seconds, or more surfels than allowed.
TEST(Holes, BadInputIsHarmless) {
    Random random(7);
    const auto any = [&] {
        return glm::vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    };
    EXPECT_TRUE(fill_points({}).empty());
    EXPECT_TRUE(fill_points({.points = {{.normal = kZ, .area = 1}}, .stations = {}}).empty());
    HoleSample place{.points = std::vector<HolePoint>(100000, {.normal = kZ, .area = 1e-4f}), .stations = {}};
    EXPECT_TRUE(fill_points(place).empty()) << "all at one place";
    HoleSample noise{.points = {}, .stations = {glm::vec3(0)}};
    for (int i = 0; i < 300000; ++i)
        noise.points.push_back(
            {.position = 20.0f * any(), .normal = glm::normalize(any()), .area = 1e-3f, .station = 0});
    EXPECT_TRUE(fill_points(noise).empty()) << "outliers";
    for (HolePoint& point : noise.points) point.position *= 1e30f;
    EXPECT_TRUE(fill_points(noise).empty()) << "larger than a scan can be";
    // Normals that are all wrong, and shares from 0 to the scan's own size.
    HoleSample wrong = scan_walls(room(), {{2, 2, 1.7f}}, 400);
    for (HolePoint& point : wrong.points) {
        point.normal = glm::normalize(any());
        point.area *= static_cast<float>(std::exp2(40 * random.uniform() - 20));
    }
    EXPECT_LE(fill_points(wrong, {.most_points = 1000}).size(), 1000u);
    // A ring around a hole that is larger than everything else.
    HoleSample ring = floor_without(8, [](const glm::vec2& at) { return glm::length(at - 4.0f) < 3.9f; });
    EXPECT_TRUE(fill_points(ring).empty());
    ring.stations = {{4, 4, 1}};
    EXPECT_TRUE(fill_points(ring).empty());
}

/// The surfels become coarser, or the smallest holes stay open, before there are too many.
TEST(Holes, TheNumberOfSurfelsIsLimited) {
    const HoleSample sample = scan_walls(room(), {{2, 2, 1.7f}});
    const size_t all = fill_points(sample).size();
    const auto fewer = fill_points(sample, {.most_points = all / 2});
    EXPECT_LE(fewer.size(), all / 2);
    EXPECT_GT(filled_area(fewer), 3);
    EXPECT_TRUE(fill_points(sample, {.most_points = 10}).empty());
}

/// The virtual scan of the Cornell box: light that leaves one surface reaches the next.
/// Pictures of few points leave synthetic surfels out if they are too many, because these have no levels of
/// detail. So large holes have larger surfels.
TEST(Holes, LargeHolesHaveFewerSurfelsOfTheSameArea) {
    const auto discs = [](int count) {
        return floor_without(12, [count](const glm::vec2& at) {
            for (int i = 0; i < count; ++i)
                if (glm::distance(at, glm::vec2(3 + 6 * (i % 2), 3 + 6 * (i / 2))) < 1.7f) return true;
            return false;
        });
    };
    const auto one = fill_points(discs(1)), four = fill_points(discs(4));
    const float expected = std::numbers::pi_v<float> * 1.7f * 1.7f;
    std::printf("%zu and %zu surfels\n", one.size(), four.size());
    EXPECT_NEAR(filled_area(one), expected, 0.05f * expected);
    EXPECT_NEAR(filled_area(four), 4 * expected, 0.2f * expected);
    EXPECT_GT(one.size(), 4u * 2000);
    EXPECT_LT(four.size(), 2 * one.size()) << "one surfel a cell instead of four";
}

TEST(Holes, LightOfTheCornellBoxStaysInside) {
    const Scan scan = scan_of("cornell", 200000);
    NormalOptions options;
    options.stations = scan.stations;
    const Estimate found = estimate(scan.cloud, options);
    const auto points = fill_points(sample_of(scan, found));
    const HoleErrors open = hole_errors("cornell", scan, found, {}, 50000),
                     filled = hole_errors("cornell", scan, found, points, 50000);
    std::printf("cornell: %.2f m2 filled, %.3f m2 of it off; rays that pass %.2f %% -> %.2f %%\n",
                filled.filled, filled.off, 100 * open.through, 100 * filled.through);
    EXPECT_GT(filled.filled, 10);
    EXPECT_LT(filled.off, 0.01 * filled.filled);
    EXPECT_LT(filled.through, 0.7 * open.through);
}

/// Walls and vaults that end in the air, and windows in them, must not be continued.
TEST(Holes, LittleOfTheNaveIsInvented) {
    const Scan scan = scan_of("nave", 400000);
    NormalOptions options;
    options.stations = scan.stations;
    const Estimate found = estimate(scan.cloud, options);
    const HoleErrors filled = hole_errors("nave", scan, found, fill_points(sample_of(scan, found)), 1000);
    std::printf("nave: %.2f m2 filled, %.2f m2 of it off\n", filled.filled, filled.off);
    EXPECT_GT(filled.filled, 7);
    EXPECT_LT(filled.off, 0.19 * filled.filled) << "of vaults, mostly, whose holes are closed by planes";
}

}  // namespace
}  // namespace lucarne::octree
