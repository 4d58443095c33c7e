#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/growing/growing_build.h"
#include "tests/octree/test_sources.h"
#include "tests/viewer/opening/sites.h"
#include "viewer/opening/first_view.h"
#include "viewer/opening/occupancy.h"

namespace lucarne::viewer {
namespace {

using namespace sites;

TEST(Site, ARoomIsSeenFromWithinAlongItsLength) {
    for (const double unit : {1.0, .3048}) {
        const Site site = room(unit);
        ASSERT_EQ(site.kind, SiteKind::interior);
        ASSERT_TRUE(site.inside);
        const dvec3 eye = site.inside->eye * unit;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GT(eye[axis], kRoom[0][axis]) << axis;
            EXPECT_LT(eye[axis], kRoom[1][axis]) << axis;
        }
        EXPECT_NEAR(eye.z - kRoom[0].z, 1.6, .3);
        EXPECT_GT(std::abs(site.inside->ahead.y), .9) << "along the longer side";
        EXPECT_GT(site.inside->free_ahead * unit, 8) << "from the far end";
        ASSERT_FALSE(site.inside->lamps.empty());
        for (const dvec3& lamp : site.inside->lamps) {
            EXPECT_GT(lamp.z * unit, kRoom[0].z + 1.5);
            EXPECT_LT(lamp.z * unit, kRoom[1].z);
        }
    }
}

TEST(Site, OfTwoEndsOfARoomOneIsSeenInEverySample) {
    const dvec3 ahead = room().inside->ahead;
    for (uint32_t seed = 2; seed < 10; ++seed) {
        std::vector<dvec3> points;
        add_faces(points, kRoom, 20000 * seed, true, seed);
        const Site site = survey_site(points, kRoom, 1);
        ASSERT_TRUE(site.inside) << seed;
        EXPECT_GT(dot(site.inside->ahead, ahead), .9) << seed;
        EXPECT_TRUE(shown_alike(site, room())) << seed;
    }
}

TEST(Site, ViewsFromOtherEndsOrPlacesAreNotAlike) {
    const Site one = room();
    Site turned = one, moved = one;
    turned.inside->ahead = -one.inside->ahead;
    moved.inside->eye += one.inside->free_ahead / 2 * one.inside->ahead;
    EXPECT_FALSE(shown_alike(one, turned));
    EXPECT_FALSE(shown_alike(one, moved));
    EXPECT_TRUE(alike(one, turned)) << "light made for one suits the other";
    turned.kind = SiteKind::object;
    EXPECT_TRUE(shown_alike(one, turned)) << "one is seen from outside";
}

TEST(Site, NothingStandsCloselyBeforeTheEye) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 60000, true, 1);
    // Rails before both ends, lower than the eye but in its picture.
    for (const double y : {201.6, 210.4})
        for (double x = kRoom[0].x; x < kRoom[1].x; x += .01) points.emplace_back(x, y, kRoom[0].z + 1.4);
    const Site site = survey_site(points, kRoom, 1);
    ASSERT_TRUE(site.inside);
    const gi::SceneCamera camera = inside_view(site, {});
    const dvec3 forward = normalize(camera.target - camera.position);
    double nearest = 100;
    for (const dvec3& point : points) {
        const double depth = dot(point - camera.position, forward);
        if (depth <= 0) continue;
        const glm::dvec2 at = place(camera, point, 16. / 9);
        if (std::abs(at.x) < .8 && std::abs(at.y) < .8) nearest = std::min(nearest, depth);
    }
    EXPECT_GT(nearest, 1.1);
    EXPECT_GT(std::abs(site.inside->ahead.y), .9) << "still along the room";
}

TEST(Site, OfTwoWaysThatAreAsLongTheOneWithThingsIsSeen) {
    for (const double y : {200.0, 210.5}) {
        std::vector<dvec3> points;
        add_faces(points, kRoom, 60000, true, 1);
        for (int shelf = 0; shelf < 15; ++shelf) {
            const dvec3 low(100, y + .1 * shelf, 10);
            add_faces(points, {low, low + dvec3(5, .05, 2.4)}, 4000, true, 2);
        }
        const Site site = survey_site(points, kRoom, 1);
        ASSERT_TRUE(site.inside);
        EXPECT_GT(site.inside->ahead.y * (y - 206), .9) << y;
    }
}

/// A wide bench along half of the room, as high as a person's chest, under a cable tray.
TEST(Site, OneStandsOnTheFloorNotOnFurniture) {
    std::vector<dvec3> points;
    const Box high = {kRoom[0], dvec3(105, 212, 13.6)}, bench = {kRoom[0], dvec3(102.5, 212, 11.3)};
    add_faces(points, high, 60000, true, 1);
    add_faces(points, bench, 30000, true, 2);
    add_faces(points, {dvec3(100, 200, 13), dvec3(105, 203, 13.1)}, 9000, true, 3);
    const auto hidden = [&](const dvec3& p) {  // inside the bench, or under it
        return p.x < 102.4 && p.z < 11.2 && p.x > 100.1;
    };
    std::erase_if(points, hidden);
    const Site site = survey_site(points, high, 1);
    ASSERT_TRUE(site.inside);
    EXPECT_NEAR(site.inside->eye.z - kRoom[0].z, 1.6, .3);
}

TEST(Site, TheEyeStaysBelowLowCeilings) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 60000, true, 1);
    // At both ends of the room the ceiling is 1.85 m high.
    for (const double y : {200., 209.})
        add_faces(points, {dvec3(100, y, 11.85), dvec3(105, y + 3, 11.9)}, 20000, true, 3);
    const Site site = survey_site(points, kRoom, 1);
    ASSERT_TRUE(site.inside);
    EXPECT_GT(site.inside->eye.y, 202.5);
    EXPECT_LT(site.inside->eye.y, 209.5);
}

/// The points of a rectangle between two corners that differ along two axes.
void add_rectangle(std::vector<dvec3>& points, const Box& corners, size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    for (size_t i = 0; i < count; ++i)
        points.push_back(corners[0] +
                         (corners[1] - corners[0]) * dvec3(unit(random), unit(random), unit(random)));
}

Site from_station(const std::vector<dvec3>& points, const Box& box, const dvec3& station) {
    return survey_site(points, box, 1, false, {{station}, station});
}

TEST(Site, WhatOneStationSawIsSeenFromItsSide) {
    // A façade and the ground before it, scanned from the north, where objects are not looked at from
    // otherwise.
    std::vector<dvec3> points;
    add_rectangle(points, {dvec3(0, 0, 0), dvec3(10, 0, 6)}, 20000, 1);
    add_rectangle(points, {dvec3(0, 0, 0), dvec3(10, 4, 0)}, 8000, 2);
    const dvec3 station(4, 15, 1.7);
    const Site site = from_station(points, {dvec3(0), dvec3(10, 4, 6)}, station);
    ASSERT_TRUE(site.station);
    const gi::SceneCamera camera = first_view(site, {});
    EXPECT_GT(camera.position.y, 4) << "not behind the façade";
    EXPECT_LT(std::abs(place(camera, {5, 0, 3}, 4.0 / 3).x), .3f);
    for (const dvec3& corner : {dvec3(0, 0, 6), dvec3(10, 0, 6), dvec3(0, 4, 0), dvec3(10, 4, 0)}) {
        const glm::dvec2 at = place(camera, corner, 4.0 / 3);
        EXPECT_LE(std::max(std::abs(at.x), std::abs(at.y)), 1.01) << "all of it is in the picture";
    }
}

TEST(Site, APictureOfADepthCameraIsUpright) {
    for (const int down : {1, -1}) {  // y down and z ahead, or y up and z back
        std::vector<dvec3> points;
        add_rectangle(points, {dvec3(-1, -1, 3 * down), dvec3(1, 1, 3 * down)}, 20000, 1);
        add_rectangle(points, {dvec3(-.3, .9 * down, 2 * down), dvec3(.3, 1. * down, 2.2 * down)}, 3000, 2);
        const Box box = {dvec3(-1, -1, down > 0 ? 2 : -3), dvec3(1, 1, down > 0 ? 3 : -2)};
        const Site site = from_station(points, box, dvec3(0));
        ASSERT_TRUE(site.station) << down;
        const gi::SceneCamera camera = first_view(site, {});
        const glm::dvec2 above = place(camera, {0, -.8 * down, 3 * down}, 1),
                         below = place(camera, {0, .8 * down, 3 * down}, 1);
        EXPECT_GT(above.y, below.y + .5) << down;
        const glm::dvec2 left = place(camera, {-.8, 0, 3 * down}, 1),
                         right = place(camera, {.8, 0, 3 * down}, 1);
        EXPECT_GT(right.x, left.x + .5) << "not mirrored";
    }
}

TEST(Site, ACourtyardIsSeenFromTheStationInIt) {
    std::vector<dvec3> points;
    const Box court = {dvec3(0), dvec3(20, 30, 8)};
    add_faces(points, court, 60000, false, 2);
    const dvec3 station(10, 10, 1.7);
    const Site site = from_station(points, court, station);
    ASSERT_NE(site.kind, SiteKind::interior);
    ASSERT_TRUE(site.station);
    const gi::SceneCamera camera = first_view(site, {});
    EXPECT_LT(glm::distance(camera.position, station), 1e-9);
    EXPECT_NEAR(camera.target.z, camera.position.z, 1e-9);
}

TEST(Site, AStationThatSeesLittleIsNotBelieved) {
    std::vector<dvec3> points;
    const Box block = {dvec3(0), dvec3(.8, .8, 1.2)};
    add_faces(points, block, 60000, true, 2);
    EXPECT_TRUE(from_station(points, block, {.4, .4, .6}).station);
    EXPECT_FALSE(from_station(points, block, {10, 3, 1}).station) << "most sides face away from it";
    EXPECT_FALSE(from_station(points, block, {std::nan(""), 3, 1}).station);
    // A room that is seen from inside needs none.
    std::vector<dvec3> walls;
    add_faces(walls, kRoom, 60000, true, 1);
    EXPECT_FALSE(from_station(walls, kRoom, (kRoom[0] + kRoom[1]) / 2.0).station);
}

TEST(Site, ARoomIsSeenFromWhereAScannerStoodIfThatViewIsNearlyAsWide) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 60000, true, 1);
    const auto eye_of = [&](const std::vector<dvec3>& stations) {
        return survey_site(points, kRoom, 1, false, {stations, std::nullopt}).inside->eye;
    };
    const dvec3 without = eye_of({}), good(102.2, 201.8, 11.7), middle(102.5, 206, 11.7);
    EXPECT_LT(glm::distance(eye_of({middle, good}), good), 1e-9);
    const std::vector<std::vector<dvec3>> useless = {{middle},  // half of the room lies behind it
                                                     {{102.2, 201.8, 12.8}},  // below the ceiling
                                                     {{102.2, 198, 11.7}},    // outside
                                                     {{102.2, 201.8, std::nan("")}}};
    for (const auto& stations : useless) EXPECT_EQ(eye_of(stations), without) << stations.front().z;
}

TEST(Site, ARoomWithoutCeilingIsSeenFromOutside) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 60000, false, 2);
    const Site site = survey_site(points, kRoom, 1);
    EXPECT_NE(site.kind, SiteKind::interior);
    EXPECT_FALSE(site.inside);
}

TEST(Site, AHouseOnItsGroundIsSeenFromOutsideAndCanBeEntered) {
    std::vector<dvec3> points;
    const Box house = {dvec3(0, 0, 0), dvec3(12, 9, 4)};
    add_faces(points, house, 40000, true, 3);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(-20, 32);
    for (int i = 0; i < 60000; ++i) {
        const double x = unit(random), y = unit(random);
        if (x < -1 || x > 13 || y < -1 || y > 10) points.emplace_back(x, y, 0);
    }
    const Site site = survey_site(points, {dvec3(-20, -20, 0), dvec3(32, 32, 4)}, 1);
    EXPECT_NE(site.kind, SiteKind::interior);
    ASSERT_TRUE(site.inside);
    EXPECT_GT(site.inside->eye.x, 0);
    EXPECT_LT(site.inside->eye.x, 12);
}

TEST(Site, AMountainIsTerrain) {
    const Site site = survey_site(terrain(50000), {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1);
    EXPECT_EQ(site.kind, SiteKind::terrain);
    EXPECT_FALSE(site.inside);
}

TEST(Site, BadCloudsGiveADefinedView) {
    const double nan = std::nan("");
    const std::vector<std::vector<dvec3>> clouds = {{}, {dvec3(3)}, {dvec3(nan), dvec3(1)}};
    for (const auto& points : clouds)
        for (const Box& box : {Box{dvec3(3), dvec3(3)}, Box{dvec3(INFINITY), dvec3(-INFINITY)},
                               Box{dvec3(nan), dvec3(nan)}, Box{dvec3(0), dvec3(1e12, 1, 1)}}) {
            const Site site = survey_site(points, box, 1);
            const gi::SceneCamera camera = first_view(site, {});
            EXPECT_TRUE(std::isfinite(length(camera.position) + length(camera.target)));
            EXPECT_GT(distance(camera.position, camera.target), 0);
        }
}

TEST(Site, IsAlikeIfMorePointsOfTheSameScanAreSeen) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 20000, true, 3);
    const Site few = survey_site(points, kRoom, 1), more = room();
    EXPECT_TRUE(alike(few, more));
    EXPECT_TRUE(alike(more, few));
    Site grown = more;
    grown.box[1].y += .04 * glm::distance(kRoom[0], kRoom[1]);
    EXPECT_TRUE(alike(few, grown));
    grown.box[1].y += .02 * glm::distance(kRoom[0], kRoom[1]);
    EXPECT_FALSE(alike(few, grown)) << "the box is larger by more than a twentieth";
    Site other = more;
    other.kind = SiteKind::object;
    EXPECT_FALSE(alike(few, other));
}

TEST(Site, IsAlikeIfTheSampleDecidesBetweenTwoKinds) {
    Site inside = room(), outside = inside;
    inside.enclosed_share = .52;
    outside.enclosed_share = .47;
    outside.kind = SiteKind::object;
    EXPECT_TRUE(alike(inside, outside));
    EXPECT_TRUE(alike(outside, inside));
    outside.enclosed_share = .3;
    EXPECT_FALSE(alike(inside, outside));
}

/// Points in some places of a cloud, as the fronts of a compressed file's chunks are: of cubes of `size`,
/// every `every`-th has points.
std::vector<dvec3> some_places(const std::vector<dvec3>& points, double size, uint64_t every) {
    std::vector<dvec3> some;
    for (const dvec3& p : points) {
        uint64_t cube = 0;
        for (int axis = 0; axis < 3; ++axis)
            cube = mix64(cube, static_cast<uint64_t>(static_cast<int64_t>(std::floor(p[axis] / size))));
        if (cube % every == 0) some.push_back(p);
    }
    return some;
}

TEST(Site, ARoomIsKnownFromSomePlacesOfItsWalls) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 200000, true, 3);
    for (const double size : {.15, .25, .4}) {
        const std::vector<dvec3> some = some_places(points, size, 2);
        const Site site = survey_site(some, kRoom, 1, true);
        EXPECT_EQ(site.kind, SiteKind::interior) << size;
        EXPECT_TRUE(alike(site, room())) << size;
    }
    EXPECT_NE(survey_site(some_places(points, .4, 2), kRoom, 1).kind, SiteKind::interior)
        << "the same points without a word of gaps: the walls are open";
}

/// Two rooms of real scans as the window opens them: their first 60 000 points, the first even sample, and
/// the cache.
TEST(Site, RealRoomsAreKnownFromTheFirstPointsOfACompressedFileAndKeepTheViewOfTheFirstEvenSample) {
    const auto data = io::testing::shared_data();
    for (const char* name : {"loft.laz", "vault.laz"}) {
        if (data.empty() || !std::filesystem::exists(data / "interiors" / name))
            GTEST_SKIP() << "no shared " << name;
        const test::TempFolder folder;
        auto scan = io::open_scan(data / "interiors" / name);
        ASSERT_TRUE(scan) << scan.error().line();
        octree::GrowingBuild::Inputs inputs;
        inputs.push_back(std::move(*scan));
        octree::GrowingOptions options;
        options.build.output = folder / "a.luc";
        options.sample_points = 400'000;
        options.first_points = 60'000;
        options.first_read = 500'000;
        options.read_points = 1'000'000;
        options.build.normals = octree::NormalsMode::none;  // saves time
        const auto build = octree::GrowingBuild::open(std::move(inputs), options);
        ASSERT_TRUE(build) << build.error().line();
        const auto source = (*build)->state().source;
        EXPECT_TRUE(source->header().has_gaps);
        const Site site = survey_site(*source);
        EXPECT_EQ(site.kind, SiteKind::interior) << name << ": " << site.enclosed_share;
        EXPECT_FALSE(site.sure) << "the even points that follow may show something else";
        std::shared_ptr<const octree::NodeSource> even;
        (*build)->begin([&] {
            const auto now = (*build)->state().source;
            if (!even && !now->header().has_gaps) even = now;
        });
        (*build)->wait();
        ASSERT_TRUE((*build)->state().finished && even);
        const Site first = survey_site(*even), whole = survey_site(*(*build)->state().source);
        EXPECT_TRUE(first.sure && whole.sure) << name;
        EXPECT_TRUE(alike(first, whole) && shown_alike(first, whole)) << name;
    }
}

TEST(FirstView, OneStandsOnTheHighestGroundOfATerrain) {
    for (const double unit : {1.0, .3048}) {
        std::vector<dvec3> points = terrain(50000);
        for (dvec3& p : points) p /= unit;
        const Site site = survey_site(points, {dvec3(0, 0, -20) / unit, dvec3(400, 400, 20) / unit}, unit);
        const gi::SceneCamera camera = ground_view(site, {1.6, {}});
        const dvec3 eye = camera.position * unit;
        const double ground = 20 * std::sin(eye.x / 60) * std::cos(eye.y / 80);
        EXPECT_GT(ground, 18) << "the top of a hill";
        EXPECT_GT(eye.z - ground, 1.7);
        EXPECT_LT(eye.z - ground, 8);
        const dvec3 middle = dvec3(200, 200, 0) - eye, ahead = camera.target * unit - eye;
        EXPECT_GT(middle.x * ahead.x + middle.y * ahead.y, 0) << "toward the larger part";
    }
}

TEST(Site, GapsMakeNoRoomsOfWhatIsOutside) {
    std::vector<dvec3> points;
    const Box house = {dvec3(0, 0, 0), dvec3(12, 9, 4)};
    add_faces(points, house, 100000, false, 3);
    EXPECT_NE(survey_site(some_places(points, .3, 2), house, 1, true).kind, SiteKind::interior)
        << "no ceiling";
    const Box hills{dvec3(0, 0, -20), dvec3(400, 400, 20)};
    EXPECT_EQ(survey_site(some_places(terrain(100000), 4, 2), hills, 1, true).kind, SiteKind::terrain);
}

TEST(FirstView, AllPointsFillTheFreePartOfThePicture) {
    const std::vector<dvec3> mountain = terrain(20000);
    const Site site = survey_site(mountain, {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1);
    const FreePart free{-.4, 1, -1, .95};
    for (const double aspect : {.6, 1.0, 16.0 / 9}) {
        const gi::SceneCamera camera = outside_view(site, {aspect, free});
        glm::dvec2 low(2), high(-2);
        for (const dvec3& point : site.outline) {
            low = min(low, place(camera, point, aspect));
            high = max(high, place(camera, point, aspect));
        }
        EXPECT_GE(low.x, free.left);
        EXPECT_LE(high.x, free.right);
        EXPECT_GE(low.y, free.bottom);
        EXPECT_LE(high.y, free.top);
        const glm::dvec2 filled = (high - low) / glm::dvec2(free.right - free.left, free.top - free.bottom);
        EXPECT_GT(std::max(filled.x, filled.y), .9) << aspect;
    }
}

TEST(FirstView, RoomsAreLookedIntoFromOutside) {
    const Site site = room();
    EXPECT_TRUE(looks_in_from_outside(site, outside_view(site, {})));
    EXPECT_FALSE(looks_in_from_outside(site, inside_view(site, {})));
    gi::SceneCamera plan = inside_view(site, {});
    plan.orthographic_height = 5;
    EXPECT_TRUE(looks_in_from_outside(site, plan)) << "a plan shows no ceilings";
    const Site hills = survey_site(terrain(20000), {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1);
    EXPECT_FALSE(looks_in_from_outside(hills, outside_view(hills, {})));
}

TEST(FirstView, ParallelPicturesFitAsWell) {
    const std::vector<dvec3> corners = {dvec3(0), dvec3(4, 2, 3)};
    const ViewAxes front{dvec3(1, 0, 0), dvec3(0, 0, 1), dvec3(0, 1, 0)};
    const FreePart free{0, 1, -1, 1};
    const ParallelFit fit = parallel_fit(corners, front, {2, free}, 1e-6);
    for (const dvec3& corner : corners) {
        const dvec3 to = corner - fit.position;
        EXPECT_GT(to.y, 0);
        EXPECT_GE(to.x / fit.height, 0) << "half the width of a picture twice as wide as high is its height";
        EXPECT_LE(to.x / fit.height, 1);
        EXPECT_LE(std::abs(to.z / fit.height), .5);
    }
}

TEST(Occupancy, RaysStopAtTheFirstOccupiedCell) {
    const std::vector<dvec3> points(20, dvec3(7.5, .5, .5));
    const OccupancyGrid grid(points, {dvec3(0), dvec3(8, 1, 1)});
    const OccupancyGrid::Sight hit = grid.look({.5, .5, .5}, {1, 0, 0});
    EXPECT_TRUE(hit.blocked);
    EXPECT_NEAR(hit.distance, 7, grid.cell());
    const OccupancyGrid::Sight missed = grid.look({.5, .5, .5}, {-1, 0, 0});
    EXPECT_FALSE(missed.blocked);
    EXPECT_NEAR(missed.distance, .5, 1e-6);
}

}  // namespace
}  // namespace lucarne::viewer
