// Levels of finer voxels within coarser ones: light crosses their borders as if there were none.
#include "gi/engines/volume/nested.h"

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/volume/directions.h"
#include "gi/engines/volume/first_bounce.h"
#include "gi/engines/volume/focus.h"
#include "gi/engines/volume/read_back.h"
#include "gi/engines/volume/sweep.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/volume/volume_space.h"

namespace lucarne::gi::volume {
namespace {

using Light = std::vector<glm::vec3>;

/// A space and a finer one within it.
struct Nested {
    Space coarse, fine;
    Nested(const std::vector<FlatSurfel>& surfels, const glm::vec3& middle, uint32_t longest = 32)
        : coarse(make_space(surfels, longest)),
          fine(make_space(surfels, finer_grid(coarse.grid(), middle))) {}
};

/// The irradiance of the fine faces by one set of directions, when these faces send out light.
template <class Lit>
Light swept(const Nested& nested, const Lit& lit, float outside = 0, uint64_t seed = 1) {
    const Light coarse = radiance_of(nested.coarse, lit), fine = radiance_of(nested.fine, lit);
    const std::array spaces{&nested.coarse, &nested.fine};
    Sweeper sweeper{std::span<const Space* const>(spaces)};
    sweeper.begin(even_directions(64, seed), std::array{std::span(coarse), std::span(fine)},
                  [outside](const glm::vec3&) { return glm::vec3(outside); });
    while (sweeper.advance()) {
    }
    return sweeper.irradiance(1);
}

/// The same by gathering from them.
template <class Lit>
Light gathered(const Nested& nested, const Lit& lit) {
    FirstBounce beyond(nested.coarse), within(nested.fine);
    const Light coarse = radiance_of(nested.coarse, lit), fine = radiance_of(nested.fine, lit);
    beyond.begin(coarse, &nested.fine.grid());
    while (beyond.advance()) {
    }
    within.begin(fine);
    while (within.advance()) {
    }
    Light light = from_coarse(nested.coarse, beyond.from_outside(), nested.fine);
    for (size_t i = 0; i < light.size(); ++i) light[i] += within.irradiance()[i];
    return light;
}

bool all(const Face&) {
    return true;
}

TEST(FinerGrid, LiesInTheCoarseOneWhereverItsMiddleIs) {
    const Grid coarse = grid_about(glm::vec3(0), glm::vec3(8, 4, 1), 64);
    for (const glm::vec3& middle :
         {glm::vec3(4, 2, .5f), glm::vec3(-9), glm::vec3(1e9f), glm::vec3(0, 4, 1)}) {
        const Grid fine = finer_grid(coarse, middle);
        EXPECT_EQ(fine.voxel, coarse.voxel / 2);
        EXPECT_NEAR(fine.size.x, coarse.size.x, 2) << "half of the longest side";
        const glm::vec3 low = coarse.place(fine.low),
                        high = coarse.place(fine.position(glm::vec3(fine.size)));
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(low[axis], 0);
            EXPECT_LE(high[axis], static_cast<float>(coarse.size[axis]));
        }
        EXPECT_EQ(finer_grid(coarse, glm::vec3(1)).size.z, 2 * coarse.size.z - 1) << "all of a short axis";
    }
    const Grid fine = finer_grid(coarse, {4, 2, .5f});
    EXPECT_NEAR(fine.position(.5f * glm::vec3(fine.size)).x, 4, coarse.voxel);
}

TEST(FinerGrid, EndsWithTheCoarseOneIfItNearlyDoes) {
    const Grid coarse = grid_about(glm::vec3(0), glm::vec3(8), 64);
    for (const float off : {2.0f, 2.1f, 2.3f}) {
        const glm::vec3 low = coarse.place(finer_grid(coarse, glm::vec3(off)).low);
        const Grid upper = finer_grid(coarse, glm::vec3(8 - off));
        EXPECT_NEAR(low.x, .25f, 1e-3f) << off;
        EXPECT_NEAR(coarse.place(upper.position(glm::vec3(upper.size))).x, coarse.size.x, .3f) << off;
    }
    EXPECT_GT(coarse.place(finer_grid(coarse, glm::vec3(3)).low).x, 4);
}

TEST(FinerGrid, ReachesBothEndsOfAnAxisLittleLongerThanItself) {
    const Grid coarse = grid_about(glm::vec3(0), glm::vec3(8, 4.1f, 8), 64);
    ASSERT_GT(coarse.size.y, 32);
    ASSERT_LT(coarse.size.y, 36);
    const Grid lower = finer_grid(coarse, glm::vec3(4, 0, 4)),
               upper = finer_grid(coarse, glm::vec3(4, 4.1f, 4));
    EXPECT_NEAR(coarse.place(lower.low).y, .25f, 1e-3f);
    EXPECT_NEAR(coarse.place(upper.position(glm::vec3(upper.size))).y, coarse.size.y, .3f);
}

TEST(FinerGrid, HoldsTheAreaThatIsInIt) {
    // Large discs cross its border: a plate of 1 m^2, of which it holds what lies in its box.
    const auto surfels = flat::square(12, 1);
    const Space coarse = make_space(surfels);
    const Grid grid = finer_grid(coarse.grid(), glm::vec3(0.2f, 0.3f, 0));
    const Space fine = make_space(surfels, grid);
    const glm::vec3 low = glm::max(grid.low, glm::vec3(0.0f)),
                    high = glm::min(grid.position(glm::vec3(grid.size)), glm::vec3(1.0f));
    double area = 0;
    for (uint32_t voxel = 0; voxel < fine.voxels.occupied().size(); ++voxel)
        for (const SurfelPart& part : fine.voxels.parts(voxel)) area += part.area;
    const double held = double{high.x - low.x} * (high.y - low.y);
    EXPECT_LT(held, .5);
    EXPECT_NEAR(area / held, 1, .03);
    EXPECT_FALSE(fine.voxels.is_air({-1, 0, 0})) << "nothing is known of what is beyond";
    EXPECT_TRUE(coarse.voxels.is_air({-1, 0, 0}));
}

TEST(NestedLight, EvenLightStaysEven) {
    const Nested room(unit_cube(), glm::vec3(0.1f, 0.2f, 0.5f));  // two walls and an edge
    const Light sweep = swept(room, all), gather = gathered(room, all);
    size_t faces = 0;
    for (size_t i = 0; i < sweep.size(); ++i) {
        if (!looks_inside(room.fine.faces.all()[i])) continue;
        ++faces;
        EXPECT_NEAR(sweep[i].x / kPi, 1, 1e-3);
    }
    EXPECT_GT(faces, 1000u);
    EXPECT_NEAR(mean_share(room.fine, gather, looks_inside), 1, .01);
    // The open sky on a plate that the finer level holds a part of.
    const Nested plate(flat::square(60, 1), glm::vec3(0));
    for (const glm::vec3& sky : swept(
             plate, [](const Face&) { return false; }, 1))
        EXPECT_NEAR(sky.x / kPi, 1, 3e-3) << "the rim of the plate darkens the air beside it a little";
}

TEST(NestedLight, IsThatOfTheWholeRoom) {
    // Light of the whole floor and of one wall at a corner; the finer level holds none of the floor, and half
    // of the wall.
    const auto cube = unit_cube();
    const Nested room(cube, glm::vec3(0.9f));  // a corner away from the floor
    const Space whole = make_space(cube, 61);  // voxels about as fine everywhere
    const auto floor = [](const Face& face) { return wall(4)(face) || wall(1)(face); };
    FirstBounce truth(whole);
    const Light lit = radiance_of(whole, floor);
    truth.begin(lit);
    while (truth.advance()) {
    }
    Light sweeps = swept(room, floor);
    for (uint64_t seed = 2; seed <= 8; ++seed) {
        const Light more = swept(room, floor, 0, seed);
        for (size_t i = 0; i < sweeps.size(); ++i) sweeps[i] += more[i];
    }
    for (glm::vec3& light : sweeps) light /= 8.0f;
    const glm::vec3 low = room.fine.grid().low + 0.05f;
    for (const int side : {3, 5}) {
        const auto counts = [&](const Face& face) {
            return wall(side)(face) && glm::all(glm::greaterThan(face.position, low));
        };
        const double expected = mean_share(whole, truth.irradiance(), counts);
        EXPECT_NEAR(mean_share(room.fine, gathered(room, floor), counts) / expected, 1, .03) << side;
        EXPECT_NEAR(mean_share(room.fine, sweeps, counts) / expected, 1, .05) << side;
    }
}

TEST(NestedLight, NothingEntersASealedRoom) {
    const auto surfels = flat::noisy_room(80000);
    // The finer level ends in the room, and its border cuts walls, edges and a corner.
    for (const glm::vec3& middle :
         {glm::vec3(0), glm::vec3(1, .5f, .5f), glm::vec3(.8f), glm::vec3(1, 0, .3f)}) {
        const Nested nested(surfels, middle);
        const auto inner = [](const Face& face) {
            return glm::dot(face.normal, glm::vec3(.5f) - face.position) > 0 &&
                   glm::length(glm::max(glm::abs(face.position - .5f) - .52f, 0.0f)) == 0;
        };
        const auto outer = [&](const Face& face) { return !inner(face); };
        const Light sweep = swept(nested, outer, 1e6f), gather = gathered(nested, outer);
        size_t inside = 0;
        for (size_t i = 0; i < sweep.size(); ++i) {
            const Face& face = nested.fine.faces.all()[i];
            const auto air = coarse_air_at(nested.coarse, nested.fine, nested.fine.cell_before(face));
            if (!inner(face) || !air ||
                !nested.coarse.air.sees(glm::vec3(*air) + .5f, nested.coarse.grid().place(glm::vec3(.5f))))
                continue;
            ++inside;
            EXPECT_EQ(sweep[i], glm::vec3(0)) << i;
            EXPECT_EQ(gather[i], glm::vec3(0)) << i;
        }
        EXPECT_GT(inside, 500u);
    }
}

TEST(NestedLight, IsTheSameForAnyNumberOfThreads) {
    const Nested room(unit_cube(), glm::vec3(0.2f));
    const Light sweep = swept(room, wall(0)), gather = gathered(room, wall(0));
    const ThreadLimit limit(1);
    EXPECT_EQ(sweep, swept(room, wall(0)));
    EXPECT_EQ(gather, gathered(room, wall(0)));
}

TEST(NestedLight, FadesIntoThatOfTheCoarserLevel) {
    const auto surfels = flat::square(120, 1);
    auto coarse = std::make_shared<Space>(make_space(surfels, 64));
    const auto fine =
        std::make_shared<Space>(make_space(surfels, finer_grid(coarse->grid(), glm::vec3(.3f, .5f, 0))));
    const std::vector<LitLevel> levels = {{coarse, Light(coarse->faces.all().size(), glm::vec3(1))},
                                          {fine, Light(fine->faces.all().size(), glm::vec3(2))}};
    std::vector<SurfacePoint> points;
    for (int i = 1; i < 100; ++i)
        points.push_back({.position = {.01f * static_cast<float>(i), .5f, 0},
                          .normal = kZ,
                          .viewer = kZ,
                          .albedo = glm::vec3(1),
                          .radius = .01f});
    size_t missing = 0;
    Material white{};
    white.diffuse = glm::vec4(1);
    const auto seen = read_back(levels, points, std::vector{white}, missing);
    EXPECT_EQ(missing, 0u);
    const float one = seen.back().x;
    ASSERT_GT(one, 0);
    EXPECT_NEAR(seen[30].x / one, 2, 1e-4);
    float before = seen[30].x;
    for (size_t i = 31; i < seen.size(); ++i) {
        EXPECT_LE(seen[i].x, before + 1e-6f) << i;
        EXPECT_LE(before - seen[i].x, .4f * one) << "no step: " << i;
        before = seen[i].x;
    }
}

TEST(Focus, StaysWhereItIsWhileTheCameraMovesALittle) {
    const Focus here{3, 32, {1, 2, 3}, {1, 0, 0}};
    EXPECT_EQ(here.side_of(2), 8);
    EXPECT_NEAR(here.centre(2).x, 1 + .3 * 8, 1e-5);
    Focus near = here, far = here, turned = here;
    near.eye.y += .7f;
    far.eye.y += .9f;
    turned.forward = {0, 1, 0};
    EXPECT_TRUE(here.holds(near));
    EXPECT_FALSE(here.holds(far));
    EXPECT_FALSE(here.holds(turned));
    EXPECT_FALSE(here.holds(Focus{2, 32, here.eye, here.forward}));
    EXPECT_FALSE(here.holds(Focus{3, 64, here.eye, here.forward}));
    EXPECT_TRUE(Focus{}.holds(Focus{}));
}

}  // namespace
}  // namespace lucarne::gi::volume
