#include "gi/gather/vpls.h"

#include <atomic>
#include <utility>

#include <gtest/gtest.h>

#include "gi/gather/vpl_exchange.h"
#include "gi/shared/brdf.h"
#include "gi/tracing/exposure.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"

namespace lucarne::gi {
namespace {

/// Surfels that rays can hit, and the light that they send out.
struct Lit {
    TracedTree traced;
    std::vector<SideLight> light;

    Lit(const std::vector<Surfel>& surfels, size_t lit) : light(surfels.size()) {
        auto made = tracing::SurfelTracer::create(surfels);
        EXPECT_TRUE(made) << made.error().line();
        if (made) traced.tracer = std::move(*made);
        for (uint32_t i = 0; i < surfels.size(); ++i) {
            traced.slot_of.push_back(i);
            traced.surfel_of.push_back(i);
            if (i < lit) light[i].front = glm::vec3(1);
        }
    }
};

/// A lit square that faces down, two metres above one that faces up, and perhaps a wall between them.
Lit plates(bool wall) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {0, 0, 2}, kY, kX, 30, glm::vec3(0.5f));
    const size_t lit = surfels.size();
    scenes::add_rectangle(surfels, kO, kX, kY, 30, glm::vec3(0.5f));
    if (wall) scenes::add_rectangle(surfels, {-4, -4, 1}, 9.0f * kX, 9.0f * kY, 90, glm::vec3(0.5f));
    return {surfels, lit};
}

/// Returns what the lower plate sends out after VPLs.
glm::vec3 lower_light(Lit plates, const std::atomic<bool>* stop = nullptr) {
    SideLobes lobes;
    add_light_of_vpls(plates.traced, std::vector{scenes::material()},
                      {.sources = 256, .bounces = 1, .only_last = true, .seed = 1}, plates.light, lobes,
                      stop);
    glm::vec3 sum(0.0f);
    for (size_t i = 900; i < 1800; ++i) sum += (plates.light[i].front + plates.light[i].back) / 900.0f;
    return sum;
}

TEST(Vpls, TheirFluxIsThatOfWhatNothingCovers) {
    const Lit lit = plates(false);
    const auto exposures = tracing::exposures(*lit.traced.tracer);
    double expected = 0, flux = 0;
    for (size_t i = 0; i < 900; ++i) {
        const float radius = lit.traced.tracer->surfels()[i].radius;
        expected += kPi * kPi * radius * radius * exposures[i].front.points / tracing::kExposurePoints;
    }
    const auto vpls = place_vpls(lit.traced, lit.light, {}, 500, 3);
    ASSERT_EQ(vpls.size(), 500u);
    for (const VirtualLight& vpl : vpls) {
        EXPECT_LT(vpl.normal.z, -.99f);
        flux += kPi * kPi * vpl.radius2 * vpl.even.x;
    }
    EXPECT_NEAR(flux / expected, 1, 0.02);
}

TEST(Vpls, ThereAreNoneWhereItIsDark) {
    Lit lit = plates(false);
    lit.light.assign(lit.light.size(), {});
    EXPECT_TRUE(place_vpls(lit.traced, lit.light, {}, 500, 3).empty());
    EXPECT_EQ(lower_light(std::move(lit)), glm::vec3(0.0f));
}

// The form factor of two opposite unit squares at two metres is .0686 (Howell, C-11).
TEST(Vpls, LightGoesFromPlateToPlateByTheirFormFactorAndNotThroughAWall) {
    EXPECT_NEAR(lower_light(plates(false)).x, 0.0686 * 0.5, 0.0686 * 0.5 * 0.1);  // rims of the lit plate
    EXPECT_EQ(lower_light(plates(true)), glm::vec3(0.0f));
}

TEST(Vpls, LightIsTheSameWithOneThread) {
    const glm::vec3 all = lower_light(plates(false));
    const ThreadLimit one(1);
    EXPECT_EQ(lower_light(plates(false)), all);
}

TEST(Vpls, AStopEndsTheExchange) {
    const std::atomic<bool> stop = true;
    EXPECT_EQ(lower_light(plates(false), &stop), glm::vec3(0.0f));
}

}  // namespace
}  // namespace lucarne::gi
