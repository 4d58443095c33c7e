// Transport of light between faces: form factors first.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/volume/directions.h"
#include "gi/engines/volume/first_bounce.h"
#include "gi/engines/volume/propagation.h"
#include "gi/engines/volume/sights.h"
#include "gi/engines/volume/sweep.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "tests/gi/engines/volume/volume_space.h"

namespace lucarne::gi::volume {
namespace {

glm::vec3 dark(const glm::vec3&) {
    return glm::vec3(0.0f);
}

std::vector<glm::vec3> swept(const Space& space, const std::vector<glm::vec3>& radiance, uint64_t seed = 1,
                             const Sweeper::Outside& outside = dark) {
    Sweeper sweeper(space);
    sweeper.begin(even_directions(64, seed), std::array{std::span(radiance)}, outside);
    while (sweeper.advance()) {
    }
    return sweeper.irradiance();
}

/// The mean of sweeps along several sets of directions, as of several frames.
std::vector<glm::vec3> swept_often(const Space& space, const std::vector<glm::vec3>& radiance, int times) {
    std::vector<glm::vec3> sum(radiance.size(), glm::vec3(0.0f));
    for (int i = 0; i < times; ++i) {
        const auto light = swept(space, radiance, static_cast<uint64_t>(i + 1));
        for (size_t face = 0; face < sum.size(); ++face) sum[face] += light[face] / static_cast<float>(times);
    }
    return sum;
}

std::vector<glm::vec3> gathered(const Space& space, const std::vector<glm::vec3>& radiance) {
    FirstBounce bounce(space);
    bounce.begin(radiance);
    while (bounce.advance()) {
    }
    return {bounce.irradiance().begin(), bounce.irradiance().end()};
}

// More pairs of cells than answers are remembered, asked again and again in any order; also cells beside the
// grid, before faces of its outermost voxels.
TEST(VolumeSights, RememberedAnswersAreThoseOfTheAir) {
    const Space space = make_space(unit_cube());
    Sights sights(space);
    Random random(3);
    const auto below = [&](int count) { return static_cast<int>(count * random.uniform()); };
    std::vector<glm::ivec3> airs;
    for (const glm::ivec3 size = space.grid().size; airs.size() < 40;) {
        const int x = below(size.x), y = below(size.y), z = below(size.z);
        const glm::ivec3 cell(x, y, z);
        if (space.voxels.is_air(cell)) airs.push_back(cell);
    }
    size_t seen = 0, hidden = 0, wrong = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::ivec3 from = airs[static_cast<size_t>(below(40))];
        const Face& face = space.faces.all()[static_cast<size_t>(below(100)) * 37 % space.faces.all().size()];
        const glm::ivec3 to = space.cell_before(face), away = glm::abs(to - from);
        const bool sees = std::max({away.x, away.y, away.z}) <= 1 ||
                          space.air.sees(glm::vec3(from) + 0.5f, glm::vec3(to) + 0.5f);
        wrong += sights.see(from, to) != sees;
        ++(sees ? seen : hidden);
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(seen, 1000u);
    EXPECT_GT(hidden, 1000u);
}

// Howell's catalogue C-11 and C-14, unit squares.
constexpr double kOpposite = 0.199825, kBeside = 0.200044;

TEST(VolumeTransport, FacesOfACubeSeeEachOtherByTheirFormFactors) {
    const Space space = make_space(unit_cube());
    const auto radiance = radiance_of(space, wall(4));  // the floor
    for (const auto& [name, light] : {std::pair("swept", swept_often(space, radiance, 8)),
                                      std::pair("gathered", gathered(space, radiance))}) {
        SCOPED_TRACE(name);
        EXPECT_NEAR(mean_share(space, light, wall(5)) / kOpposite, 1, .02);
        for (const int side : {0, 1, 2, 3})
            EXPECT_NEAR(mean_share(space, light, wall(side)) / kBeside, 1, .05) << side;
        double sum = 0;
        for (int side = 0; side < kSides; ++side) sum += mean_share(space, light, wall(side));
        EXPECT_NEAR(sum, 1, .02) << "all that leaves the floor arrives";
    }
    // One set of 64 directions.
    EXPECT_NEAR(mean_share(space, swept(space, radiance), wall(5)) / kOpposite, 1, .06);
}

/// The form factor between two equal squares with parallel sides of length 1 at this distance (Howell's
/// catalogue, C-11).
double between_squares(double distance) {
    const double x = 1 / distance, a = std::sqrt(1 + x * x);
    return 2 / (M_PI * x * x) *
           (std::log(std::sqrt(std::pow(1 + x * x, 2) / (1 + 2 * x * x))) + 2 * x * a * std::atan(x / a) -
            2 * x * std::atan(x));
}

TEST(VolumeTransport, PlatesFarApartSeeEachOtherByTheirFormFactor) {
    EXPECT_NEAR(between_squares(1), kOpposite, 1e-5);
    // Diffusion brings less than a tenth of this over 16 voxels.
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, kX, kY, 60, glm::vec3(.5f));
    scenes::add_rectangle(surfels, 4.0f * kZ, kY, kX, 60, glm::vec3(.5f));
    const Space space = make_space(flat::of(surfels), 64);  // 61 voxels from plate to plate
    const auto inside = [](int side) {
        return [side](const Face& face) {
            return face.side == side && (side == 4 ? face.position.z < 1 : face.position.z > 3);
        };
    };
    const auto radiance = radiance_of(space, inside(4));
    EXPECT_NEAR(mean_share(space, gathered(space, radiance), inside(5)) / between_squares(4), 1, .02);
}

TEST(VolumeTransport, PlatesSixteenVoxelsApartSeeEachOtherByTheirFormFactor) {
    // Diffusion brings half of this. In sweeps the voxels at the edges of the plates, which are half empty,
    // shine like whole ones: the plate is larger by 1/29 along each side.
    const float distance = 16.0f / 29;
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, kX, kY, 60, glm::vec3(.5f));
    scenes::add_rectangle(surfels, distance * kZ, kY, kX, 60, glm::vec3(.5f));
    const Space space = make_space(flat::of(surfels));
    const auto inside = [&](int side) {
        return [side, distance](const Face& face) {
            return face.side == side && (face.position.z < .5f * distance) == (side == 4);
        };
    };
    const auto radiance = radiance_of(space, inside(4));
    const double truth = between_squares(distance);
    EXPECT_NEAR(mean_share(space, gathered(space, radiance), inside(5)) / truth, 1, .03);
    EXPECT_NEAR(mean_share(space, swept_often(space, radiance, 8), inside(5)) / truth / (30 * 30 / 29. / 29.),
                1, .02);
}

TEST(VolumeTransport, PlatesAtARightAngleSeeEachOtherByTheirFormFactor) {
    // Much of this light goes from one voxel to the next.
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, kX, kY, 100, glm::vec3(.5f));
    scenes::add_rectangle(surfels, kO, kY, kZ, 100, glm::vec3(.5f));
    for (const uint32_t voxels : {32u, 64u}) {
        const Space space = make_space(flat::of(surfels), voxels);
        const auto radiance = radiance_of(space, [](const Face& face) { return face.normal.x > .9f; });
        const auto light = smoothed(space, gathered(space, radiance));
        EXPECT_NEAR(mean_share(space, light, [](const Face& face) { return face.normal.z > .9f; }) / kBeside,
                    1, .01)
            << voxels;
    }
}

TEST(VolumeTransport, EvenLightStaysEven) {
    const Space space = make_space(unit_cube());
    const auto all = radiance_of(space, [](const Face&) { return true; });
    const auto light = swept(space, all);
    for (size_t i = 0; i < light.size(); ++i) {
        if (!looks_inside(space.faces.all()[i])) continue;
        EXPECT_NEAR(light[i].x / kPi, 1, 1e-3);
    }
    EXPECT_NEAR(mean_share(space, gathered(space, all), looks_inside), 1, .02);
    // The open sky on a plate, on either side.
    const Space plate = make_space(flat::square(60, 1));
    const auto sky = swept(plate, radiance_of(plate, [](const Face&) { return false; }), 1,
                           [](const glm::vec3&) { return glm::vec3(1.0f); });
    for (const glm::vec3& irradiance : sky) EXPECT_NEAR(irradiance.x / kPi, 1, 1e-3);
}

/// Expects that nothing enters a sealed room of such surfels, in grids of so many voxels.
void expect_sealed(const std::vector<FlatSurfel>& room, std::initializer_list<uint32_t> grids) {
    const auto inner = [](const Face& face) {
        return glm::dot(face.normal, glm::vec3(.5f) - face.position) > 0 &&
               glm::length(glm::max(glm::abs(face.position - .5f) - .52f, 0.0f)) == 0;
    };
    for (const uint32_t longest : grids) {
        SCOPED_TRACE(longest);
        const Space space = make_space(room, longest);
        const auto outer = radiance_of(space, [&](const Face& face) { return !inner(face); });
        const auto light = swept(space, outer, 1, [](const glm::vec3&) { return glm::vec3(1e6f); });
        const auto first = gathered(space, outer);
        size_t inside = 0;
        for (size_t i = 0; i < light.size(); ++i) {
            // A face that looks inward and sees the middle of the room is inside.
            const Face& face = space.faces.all()[i];
            if (!inner(face) ||
                !space.air.sees(glm::vec3(space.cell_before(face)) + .5f, space.grid().place(glm::vec3(.5f))))
                continue;
            ++inside;
            EXPECT_EQ(light[i], glm::vec3(0)) << i;
            EXPECT_EQ(first[i], glm::vec3(0)) << i;
        }
        EXPECT_GT(inside, 2 * longest * longest);
    }
}

TEST(VolumeTransport, NothingEntersASealedRoom) {
    expect_sealed(flat::noisy_room(20000), {12u, 16u, 22u, 32u});
}

TEST(VolumeTransport, NothingEntersASealedRoomOfDiscsLikeThoseOfScans) {
    // Discs of scans cover five to nine times their shares of the surface, so that gaps are smaller than
    // they.
    for (const float coverage : {5.0f, 7.0f, 9.0f}) {
        SCOPED_TRACE(coverage);
        auto room = flat::noisy_room(20000);
        for (FlatSurfel& surfel : room) surfel.radius = std::sqrt(coverage * surfel.area / kPi);
        expect_sealed(room, {16u, 27u, 40u});
    }
}

TEST(VolumeTransport, NothingEntersASealedRoomBesideOpenings) {
    // Bars and posts before its walls: the voxels between them and the walls are openings.
    auto room = flat::noisy_room(20000);
    for (const float away : {.02f, .05f, .09f}) {
        std::vector<Surfel> bars;
        for (const float x : {.1f, .3f, .45f, .8f}) {
            const glm::vec3 along(x, 0, 1 + away), across(0, x, 1 + away), side(1 + away, x, 0);
            scenes::add_rectangle(bars, along, .04f * kX, kY, 40, glm::vec3(.5f));
            scenes::add_rectangle(bars, across, kX, .03f * kY, 40, glm::vec3(.5f));
            scenes::add_rectangle(bars, side, .02f * kY, kZ, 40, glm::vec3(.5f));
        }
        for (const Surfel& bar : bars) room.push_back(flat::of(bar));
    }
    expect_sealed(room, {12u, 16u, 19u, 22u, 27u});
}

TEST(VolumeTransport, OpeningsOfAVoxelLetTheirShareOfLightThrough) {
    // A floor, a plate with a slit of one voxel that lies in two, and a ceiling.
    std::vector<Surfel> sheets;
    for (const float z : {0.0f, 0.5f, 1.0f})
        scenes::add_rectangle(sheets, z * kZ, kX, kY, 120, glm::vec3(.5f));
    std::erase_if(
        sheets, [](const Surfel& s) { return s.position.z == 0.5f && std::abs(s.position.x - .5f) < .04f; });
    const auto surfels = flat::of(sheets);
    const Space space = make_space(surfels, 16);
    const auto lit =
        radiance_of(space, [](const Face& face) { return face.side == 4 && face.position.z < .2f; });
    const auto above = [](const Face& face) {
        return face.side == 5 && face.position.z > .8f && std::abs(face.position.x - .5f) < .1f;
    };
    // The slit shines like the floor: its form factor, summed over strips.
    double truth = 0;
    constexpr int kStrips = 40;
    for (int x = 0; x < kStrips; ++x)
        for (int y = 0; y < kStrips; ++y)
            for (int along = 0; along < kStrips; ++along) {
                const double u = .2 * ((x + .5) / kStrips - .5), v = (y + .5 - along - .5) / kStrips;
                const double distance2 = u * u + v * v + .25;
                truth += .25 / (M_PI * distance2 * distance2) * .08 / std::pow(kStrips, 3);
            }
    EXPECT_NEAR(mean_share(space, swept_often(space, lit, 8), above) / truth, 1, .2);
}

TEST(VolumeTransport, TheFarSideOfAWallLightsNothingWhereSomethingElseIsSeen) {
    // A floor and a scanned ceiling, whose discs touch two layers of voxels: noise puts parts of its upper
    // side, which the sun lights, before its lower one.
    auto surfels = flat::square(60, 1);
    surfels.push_back(flat::of(Surfel{kZ, kZ, glm::vec3(.5f), .001f, 1e-6f, 0}));
    Random random(1);
    for (FlatSurfel surfel : flat::square(60, 1)) {
        surfel.z = 0.5f + 0.005f * (static_cast<float>(random.uniform()) - 0.5f);
        surfels.push_back(surfel);
    }
    const Space space = make_space(surfels);
    const auto floor = [](const Face& face) { return face.side == 4 && face.position.z < .2f; };
    const auto above = [](const Face& face) { return face.side == 4 && face.position.z > .4f; };
    const auto dark_above = radiance_of(space, floor);
    auto sunny_above = dark_above;
    for (size_t i = 0; i < sunny_above.size(); ++i)
        if (above(space.faces.all()[i])) sunny_above[i] = glm::vec3(1000);
    const auto expected = gathered(space, dark_above), light = gathered(space, sunny_above);
    size_t below = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        const Face& face = space.faces.all()[i];
        if (face.side != 5 || std::abs(face.position.z - .5f) > .1f) continue;
        ++below;
        EXPECT_LE(light[i].x, 1.1f * expected[i].x) << i;
    }
    EXPECT_GT(below, 500u);
}

TEST(VolumeTransport, IsTheSameForAnyNumberOfThreads) {
    const Space space = make_space(unit_cube());
    const auto radiance = radiance_of(space, wall(0));
    const auto light = swept(space, radiance), first = gathered(space, radiance);
    const ThreadLimit limit(1);
    EXPECT_EQ(light, swept(space, radiance));
    EXPECT_EQ(first, gathered(space, radiance));
}

TEST(VolumeTransport, SmoothingKeepsEvenValuesAndWholeEnergies) {
    const Space space = make_space(unit_cube());
    const auto even = smoothed(space, std::vector<glm::vec3>(space.faces.all().size(), glm::vec3(3)));
    for (const glm::vec3& value : even) EXPECT_NEAR(value.x, 3, 1e-5);
    const auto floor = smoothed(space, radiance_of(space, wall(4)));
    EXPECT_NEAR(mean_share(space, floor, wall(4)) * kPi, 1, 1e-5);
    for (const int side : {0, 1, 2, 3, 5}) EXPECT_EQ(mean_share(space, floor, wall(side)), 0) << side;
}

TEST(Propagation, LosesNoLightInTheAir) {
    // Two surfels far apart, which make a grid of 32^3 voxels.
    std::vector<FlatSurfel> surfels = {flat::of(Surfel{kO, kZ, glm::vec3(.5f), .001f, 1e-6f, 0}),
                                       flat::of(Surfel{glm::vec3(1), kZ, glm::vec3(.5f), .001f, 1e-6f, 0})};
    const Space space = make_space(surfels, 32);
    Propagation propagation(space);
    const std::vector<glm::vec3> dark(space.faces.all().size(), glm::vec3(0.0f));
    propagation.begin(dark, 12);
    propagation.inject(space.grid().size / 2, glm::normalize(glm::vec3(1, 2, 3)), glm::vec3(1, 2, 3));
    EXPECT_NEAR(propagation.under_way().y, 2, 1e-5);
    while (propagation.advance()) {
    }
    EXPECT_NEAR(propagation.under_way().x, 1, 1e-4);
    EXPECT_NEAR(propagation.under_way().z, 3, 3e-4);
}

TEST(Propagation, BringsAllLightOfAClosedRoomToItsWallsButLittleOfItFar) {
    const Space space = make_space(unit_cube());
    Propagation propagation(space);
    const auto arrived = [&](const std::vector<glm::vec3>& radiance, uint32_t iterations) {
        propagation.begin(radiance, iterations);
        while (propagation.advance()) {
        }
        return propagation.irradiance();
    };
    const auto even = arrived(radiance_of(space, looks_inside), 512);
    EXPECT_NEAR(mean_share(space, even, looks_inside), 1, .03);
    // The paper's iterations: diffusion brings a thousandth of the floor's light to the ceiling, not a fifth.
    const auto floor = arrived(radiance_of(space, wall(4)), 64);
    EXPECT_GT(mean_share(space, floor, wall(5)), 0);
    EXPECT_LT(mean_share(space, floor, wall(5)), .02);
}

TEST(FormFactor, OfSquaresIsThatOfTheCatalogue) {
    // A unit square, 1 above a small surface under a corner of it (Howell's catalogue B-4, four quarters).
    const auto corner = [](double a, double b) {
        const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
        return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * M_PI);
    };
    EXPECT_NEAR(form_factor(kO, kZ, kZ, -kZ, 1), 4 * corner(.5, .5), 1e-6);
    EXPECT_NEAR(form_factor(kO, kZ, glm::vec3(.5f, .5f, 1), -kZ, 1), corner(1, 1), 1e-6);
    EXPECT_EQ(form_factor(kO, kZ, kZ, kZ, 1), 0) << "from behind";
    EXPECT_EQ(form_factor(kO, -kZ, kZ, -kZ, 1), 0) << "below the horizon";
    // A wall that stands on the plane of the surface and ends on it, half of which is below the horizon.
    const float standing = form_factor(kO, kZ, kX, -kX, 1);
    EXPECT_GT(standing, 0);
    EXPECT_LT(standing, form_factor(kO, kZ, glm::vec3(1, 0, .5f), -kX, 1));
}

TEST(Directions, AreEvenAndTurnWithTheSeed) {
    for (const uint32_t count : {32u, 64u, 256u}) {
        const Directions a = even_directions(count, 1), b = even_directions(count, 2);
        ASSERT_EQ(a.ways.size(), count);
        EXPECT_NE(a.ways[0], b.ways[0]);
        glm::vec3 sum(0.0f);
        for (const glm::vec3& way : a.ways) sum += way;
        EXPECT_LT(glm::length(sum), .02f * static_cast<float>(count));
        for (int side = 0; side < kSides; ++side)
            EXPECT_NEAR(a.weights[static_cast<size_t>(side)] * static_cast<float>(count) / (4 * kPi), 1, .05);
    }
}

}  // namespace
}  // namespace lucarne::gi::volume
