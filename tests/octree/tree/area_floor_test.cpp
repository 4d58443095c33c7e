#include "octree/tree/area_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::octree {
namespace {

double floored_sum(std::span<const float> areas, double floor) {
    return std::accumulate(areas.begin(), areas.end(), 0.0,
                           [&](double sum, float a) { return sum + std::max<double>(a, floor); });
}

std::vector<float> random_areas(size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<float> areas(count);
    // Over four decades, a tenth of them unknown, some repeated, as in nodes of uneven scans.
    for (float& a : areas) {
        const double u = random.uniform();
        a = u < 0.1 ? 0.0f : u < 0.2 ? 0.01f : static_cast<float>(std::pow(10.0, -4.0 * random.uniform()));
    }
    return areas;
}

TEST(AreaFloor, FlooredAreasAddUpToTheSurfaceAtEveryPrefix) {
    for (const size_t own_count : {1u, 2u, 7u, 8u, 1000u, 4097u}) {
        const auto inherited = random_areas(own_count / 3, own_count),
                   own = random_areas(own_count, own_count + 1);
        const double full = floored_sum(inherited, 0) + floored_sum(own, 0);
        for (const double share : {1.0001, 1.5, 10.0}) {
            const double surface = full * share;
            const auto floors = area_floors(inherited, own, surface);
            for (size_t step = 0; step < kPrefixSteps; ++step) {
                std::vector<float> used(inherited);
                used.insert(used.end(), own.begin(),
                            own.begin() + static_cast<ptrdiff_t>(std::max<size_t>(1, own_count >> step)));
                EXPECT_NEAR(floored_sum(used, floors[step]) / surface, 1.0, 1e-5) << own_count << " " << step;
            }
        }
    }
}

TEST(AreaFloor, GrowsAsThePrefixShrinks) {
    const auto own = random_areas(3000, 5);
    const auto floors = area_floors({}, own, floored_sum(own, 0) * 0.9);
    EXPECT_EQ(floors[0], 0.0f) << "the areas alone exceed the surface";
    EXPECT_LT(floors[0], floors[1]);
    EXPECT_LT(floors[1], floors[2]);
    EXPECT_LT(floors[2], floors[3]);
}

TEST(AreaFloor, IsZeroWhereTheAreasAddUpToTheSurfaceButForRounding) {
    const auto own = random_areas(3000, 6);
    for (const double rounding : {-1e-13, 0.0, 1e-13})
        EXPECT_EQ(area_floors({}, own, floored_sum(own, 0) * (1 + rounding))[0], 0.0f) << rounding;
}

TEST(AreaFloor, UnknownAreasShareTheSurfaceEvenly) {
    const std::vector<float> own(64, 0.0f), inherited(16, 0.0f);
    const auto floors = area_floors(inherited, own, 8.0);
    for (size_t step = 0; step < kPrefixSteps; ++step)
        EXPECT_FLOAT_EQ(floors[step], 8.0f / static_cast<float>(16 + (64 >> step)));
}

TEST(AreaFloor, NonsenseGivesZeroOrCountsAsUnknown) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const std::vector<float> own = {nan, inf, -3.0f, 0.0f};
    EXPECT_FLOAT_EQ(area_floors({}, own, 4.0)[0], 1.0f);
    EXPECT_EQ(area_floors({}, own, static_cast<double>(nan))[0], 0.0f);
    EXPECT_EQ(area_floors({}, own, -1.0)[3], 0.0f);
    EXPECT_EQ(area_floors({}, {}, 1.0)[0], 0.0f);
    EXPECT_FLOAT_EQ(area_floors(std::vector<float>{0.0f, 0.0f}, {}, 1.0)[3], 0.5f);
}

}  // namespace
}  // namespace lucarne::octree
