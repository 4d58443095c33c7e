#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"
#include "tests/io/synthetic/random_direction.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

std::shared_ptr<const SceneGeometry> geometry_of(const std::string& scene) {
    return SceneGeometry::create(scene).value();
}

TEST(SyntheticScenes, SealedRoomsAreWatertight) {
    for (const auto& [scene, inside] : {std::pair{"furnace", dvec3(.3, -.2, .1)},
                                        {"two-rooms", dvec3(1.1, 1.3, 1.5)},
                                        {"two-rooms", dvec3(6.9, 2.2, 1.2)},
                                        {"lattice", dvec3(3.3, 2.4, 1.5)},
                                        {"lattice", dvec3(5.4, .7, 1.4)}}) {
        const auto geometry = geometry_of(scene);
        Random random(11);
        size_t escaped = 0;
        for (int i = 0; i < 500'000; ++i) escaped += geometry->cast(inside, random_direction(random)) ? 0 : 1;
        // Rays that start anywhere on the surface as well.
        for (int i = 0; i < 200'000; ++i) {
            const auto from = geometry->cast(inside, random_direction(random));
            ASSERT_TRUE(from);
            dvec3 direction = random_direction(random);
            if (dot(direction, from->normal) < 0) direction = -direction;
            escaped += geometry->cast(from->position + from->normal * 1e-4, direction) ? 0 : 1;
        }
        EXPECT_EQ(escaped, 0u) << scene;
    }
}

TEST(SyntheticScenes, TheAirIsOnTheSideOfTheNormal) {
    // From a station in the air, every visible surface shows its front.
    for (const auto& scene : synthetic_scenes()) {
        const auto geometry = geometry_of(scene.name);
        size_t seen = 0, behind = 0;
        Random random(5);
        for (const dvec3& station : geometry->model().stations)
            for (int i = 0; i < 50'000; ++i) {
                const dvec3 direction = random_direction(random);
                const auto hit = geometry->cast(station, direction);
                if (!hit) continue;
                ++seen;
                behind += dot(hit->normal, direction) > 1e-9 ? 1 : 0;
            }
        // A ray may slip through the seam between a body and the wall it stands against.
        EXPECT_LT(static_cast<double>(behind), 2e-5 * static_cast<double>(seen)) << scene.name;
        EXPECT_GT(seen, 50'000u) << scene.name;
    }
}

TEST(SyntheticScenes, AreasAreThoseOfTheBodies) {
    EXPECT_NEAR(geometry_of("furnace")->area(), 24, 1e-9);
    // Five walls of the Cornell box, and the blocks' sides and tops from their corners.
    const auto block = [](std::initializer_list<std::array<double, 2>> corners, double height) {
        const std::vector<std::array<double, 2>> c(corners);
        double around = 0, twice_top = 0;
        for (size_t i = 0; i < c.size(); ++i) {
            const auto &a = c[i], &b = c[(i + 1) % c.size()];
            around += std::hypot(b[0] - a[0], b[1] - a[1]);
            twice_top += a[0] * b[1] - a[1] * b[0];
        }
        return around * height + std::abs(twice_top) / 2;
    };
    const double blocks = block({{1.30, .65}, {.82, 2.25}, {2.40, 2.72}, {2.90, 1.14}}, 1.65) +
                          block({{4.23, 2.47}, {2.65, 2.96}, {3.14, 4.56}, {4.72, 4.06}}, 3.30);
    EXPECT_NEAR(geometry_of("cornell")->area(), 5 * 5.5 * 5.5 + blocks, 1e-5);
}

TEST(SyntheticScenes, TheStatueIsAClosedBody) {
    // Any straight line that misses the plinth enters the statue as often as it leaves it.
    const auto statue = geometry_of("statue");
    Random random(3);
    size_t through = 0;
    for (int i = 0; i < 20'000; ++i) {
        dvec3 origin(-3, 2.4 * random.uniform() - 1.2, 1.2 + 1.6 * random.uniform());
        const dvec3 direction = glm::normalize(dvec3(1, .2 * random.uniform() - .1, .2 * random.uniform()));
        int crossings = 0;
        for (; crossings < 40; ++crossings) {
            const auto hit = statue->cast(origin, direction);
            if (!hit) break;
            origin = hit->position + direction * 1e-5;
        }
        EXPECT_EQ(crossings % 2, 0);
        through += crossings > 0 ? 1 : 0;
    }
    EXPECT_GT(through, 2000u);
}

TEST(SyntheticScenes, OneDoorIsOpenAndTheOtherClosed) {
    const auto geometry = geometry_of("two-rooms");
    // Straight through each doorway from the first room (x < 4) to the second (x > 4.2), heights and widths.
    size_t open = 0, closed = 0, tried = 0;
    for (double y = .03; y < .9; y += .06)
        for (double z = .05; z < 2.1; z += .1) {
            ++tried;
            const auto through = geometry->cast({3.5, .8 + y, z}, {1, 0, 0});
            open += through && through->position.x > 4.3 ? 1 : 0;
            const auto stopped = geometry->cast({3.5, 3.2 + y, z}, {1, 0, 0});
            closed += stopped && std::abs(stopped->position.x - 4.08) < 1e-4 ? 1 : 0;
        }
    EXPECT_EQ(open, tried);
    EXPECT_EQ(closed, tried);
    // No ray from the first room reaches the second other than through the open door.
    Random random(9);
    for (int i = 0; i < 300'000; ++i) {
        const dvec3 from(1.0, 4.2, 1.5), direction = random_direction(random);
        const auto hit = geometry->cast(from, direction);
        ASSERT_TRUE(hit);
        if (hit->position.x <= 4.2001) continue;
        const dvec3 at = from + direction * ((4.1 - from.x) / direction.x);
        EXPECT_TRUE(at.y > .79 && at.y < 1.71 && at.z < 2.11) << at.y << " " << at.z;
    }
}

TEST(SyntheticScenes, LightReachesTheSecondRoomOfTheHouseOnlyOverTheDoor) {
    const auto geometry = geometry_of("house");
    Random random(9);
    size_t through = 0;
    for (int i = 0; i < 300'000; ++i) {
        const dvec3 from(6.0, 3.2, 1.4), direction = random_direction(random);
        const auto hit = geometry->cast(from, direction);
        ASSERT_TRUE(hit);  // no ray leaves the house from here
        if (hit->position.x >= 4.0999) continue;
        const dvec3 at = from + direction * ((4.1 - from.x) / direction.x);
        EXPECT_TRUE(at.y > 2.39 && at.y < 3.31 && at.z > 2.09 && at.z < 2.41) << at.y << " " << at.z;
        ++through;
    }
    EXPECT_GT(through, 500u);
    EXPECT_FALSE(geometry->cast({2, 1, 1.5}, {0, -1, 0})) << "the window is open";
    EXPECT_TRUE(geometry->cast({3.5, 1, 1.5}, {0, -1, 0})) << "the wall beside it is not";
}

TEST(SyntheticScenes, NoRayCrossesTheDiagonalWallOfTheLatticeAndManyPassItsScreens) {
    const auto geometry = geometry_of("lattice");
    Random random(9);
    size_t behind_slats = 0, behind_board = 0;
    for (int i = 0; i < 200'000; ++i) {
        const auto dark = geometry->cast({5.4, .7, 1.4}, random_direction(random));
        ASSERT_TRUE(dark);
        EXPECT_GT(dark->position.x - dark->position.y, 3.8) << "the corner is shut off";
        const auto lit = geometry->cast({3.1, 2.2, 1.4}, random_direction(random));
        ASSERT_TRUE(lit);
        EXPECT_LT(lit->position.x - lit->position.y, 3.83);
        behind_slats += lit->position.x < 1.19 ? 1 : 0;
        behind_board += lit->position.y > 3.9 && lit->position.x > 2 && lit->position.x < 4.2 &&
                                lit->position.z > .4 && lit->position.z < 2.2
                            ? 1
                            : 0;
    }
    EXPECT_GT(behind_slats, 5000u);
    EXPECT_GT(behind_board, 5000u);
}

TEST(SyntheticScenes, LightReachesTheLoftOnlyThroughItsWindows) {
    const auto geometry = geometry_of("loft");
    Random random(13);
    size_t south = 0, west = 0;
    for (int i = 0; i < 300'000; ++i) {
        const dvec3 from(3.2, 2.9, 1.6), direction = random_direction(random);
        const auto hit = geometry->cast(from, direction);
        const bool leaves = !hit || hit->position.x < -.26 || hit->position.y < -.26;
        if (!leaves) continue;
        const dvec3 at_south = from + direction * (-from.y / direction.y),
                    at_west = from + direction * (-from.x / direction.x);
        if (direction.y < 0 && at_south.x > 0) {
            const double x = at_south.x > 3 ? at_south.x - 2.7 : at_south.x;
            EXPECT_TRUE(x > .899 && x < 2.501 && at_south.z > .499 && at_south.z < 2.401)
                << x << " " << at_south.z;
            ++south;
        } else {
            EXPECT_TRUE(at_west.y > 1.599 && at_west.y < 3.201 && at_west.z > .899 && at_west.z < 2.201);
            ++west;
        }
    }
    EXPECT_GT(south, 5000u);
    EXPECT_GT(west, 1000u);
    EXPECT_TRUE(geometry->cast({1.7, 2, 2.0}, {0, -1, 0})) << "the bar in the middle of a window";
    EXPECT_FALSE(geometry->cast({1.3, 2, 2.0}, {0, -1, 0}));
    const auto tread = geometry->cast({5.0, 4.5, 2.9}, {0, 0, -1});
    ASSERT_TRUE(tread);
    EXPECT_NEAR(tread->position.z, 5 * 1.7 / 8, 1e-5) << "the fifth step";
    EXPECT_GT(geometry->cast({4.87, 4.5, .95}, {1, 0, 0})->position.x, 5.5)
        << "the stairs are open between treads";
}

TEST(SyntheticScenes, LeavesLetSomeOfTheLightThrough) {
    const auto geometry = geometry_of("arbour");
    size_t through = 0, rays = 0;
    for (double x = -1.3; x < 1.3; x += .013)
        for (double y = -1.3; y < 1.3; y += .013) {
            const auto hit = geometry->cast({x, y, 2.2}, {0, 0, 1});
            through += hit ? 0 : 1;
            ++rays;
        }
    const double open = static_cast<double>(through) / static_cast<double>(rays);
    EXPECT_GT(open, .1);
    EXPECT_LT(open, .4);
}

TEST(SyntheticScenes, WindowsOfTheNaveAreOpenAndItsWallsAreNot) {
    const auto geometry = geometry_of("nave");
    const dvec3 middle(0, 12.5, 9.5);
    for (const double side : {-1.0, 1.0}) {
        for (const double y : {-.85, .85}) {
            const dvec3 window(side * 3.2, 12.5 + y, 9.5);
            EXPECT_FALSE(geometry->cast(middle, glm::normalize(window - middle))) << "clerestory";
        }
        EXPECT_TRUE(geometry->cast(middle, {side, 0, 0})) << "the mullion between two lancets";
        const dvec3 oculus(side * 3.2, 12.5, 12.5), below(0, 12.5, 12.4);
        EXPECT_FALSE(geometry->cast(below, glm::normalize(oculus - below)));
        EXPECT_FALSE(geometry->cast({side * 4.75, 12.5, 3}, {side, 0, 0})) << "aisle";
    }
    EXPECT_FALSE(geometry->cast({0, 20, 10.7}, {0, 1, 0})) << "the rose's hub";
    EXPECT_TRUE(geometry->cast({0, 20, 10.7 + .68}, {0, 1, 0})) << "the stone around it";
    EXPECT_TRUE(geometry->cast({0, 10, 1}, {0, -1, 0})) << "the portal is shut";
    // Only openings let rays out: all rays that escape from a station pass through the height of windows.
    Random random(7);
    size_t escaped = 0;
    for (int i = 0; i < 300'000; ++i) {
        const dvec3 from(0, 11.6, 1.7), direction = random_direction(random);
        if (geometry->cast(from, direction)) continue;
        ++escaped;
        EXPECT_GT(direction.z, 0) << "nothing leaves through the floor";
        EXPECT_LT(direction.z, .95) << "or through the crown of the vault";
    }
    EXPECT_GT(escaped, 300u);
    EXPECT_LT(escaped, 30'000u);
}

TEST(SyntheticScenes, TheNearestPlaceAgreesWithTheRays) {
    const auto geometry = geometry_of("statue");
    Random random(21);
    for (int i = 0; i < 2000; ++i) {
        const dvec3 from(3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5, 3 * random.uniform());
        const auto nearest = geometry->closest(from);
        ASSERT_TRUE(nearest);
        EXPECT_NEAR(glm::length(nearest->position - from), nearest->distance, 1e-9);
        // Nothing that a ray finds is nearer, and a ray towards the nearest place finds it.
        const auto any = geometry->cast(from, random_direction(random));
        if (any) {
            EXPECT_GE(any->distance, nearest->distance - 1e-5);
        }
        if (nearest->distance < 1e-3) continue;
        const auto there = geometry->cast(from, (nearest->position - from) / nearest->distance);
        if (there) {
            EXPECT_NEAR(there->distance, nearest->distance, 1e-4);
        }
        EXPECT_FALSE(geometry->closest(from, nearest->distance * .999));
    }
}

}  // namespace
}  // namespace lucarne::io
