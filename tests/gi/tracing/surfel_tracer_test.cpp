#include "gi/tracing/surfel_tracer.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace lucarne::gi::tracing {
namespace {

/// A disc of 1 m in the plane z = 0 that ends at x = `line` (0: nowhere).
Surfel disc_until(float line) {
    Surfel surfel{{0, 0, 0}, {0, 0, 1}, glm::vec3(0.5f), 1, 1, 0};
    if (line > 0) surfel.edge = {1 / line, 0, 0};
    return surfel;
}

TEST(SurfelTracer, RaysPassDiscsBeyondTheirLines) {
    Surfel behind = disc_until(0);
    behind.position.z = -1;
    const auto made = SurfelTracer::create({disc_until(0.25f), behind});
    ASSERT_TRUE(made);
    const SurfelTracer& tracer = **made;
    const glm::vec3 down(0, 0, -1);
    EXPECT_EQ(tracer.nearest({0.24f, 0.5f, 1}, down), 0u);
    EXPECT_EQ(tracer.nearest({0.26f, 0.5f, 1}, down), 1u);
    EXPECT_EQ(tracer.nearest({-0.9f, 0, 1}, down), 0u);
    EXPECT_TRUE(tracer.occluded({0.24f, 0, 1}, {0.24f, 0, -0.5f}));
    EXPECT_FALSE(tracer.occluded({0.26f, 0, 1}, {0.26f, 0, -0.5f}));
    EXPECT_TRUE(tracer.occluded_along({0.26f, 0, 1}, down)) << "by the disc behind";
    for (const float x : {0.24f, 0.26f}) {
        std::vector<uint32_t> crossed;
        tracer.each_crossed({x, 0, 1}, down, 0, 3, [&](uint32_t i) { crossed.push_back(i); });
        std::ranges::sort(crossed);
        EXPECT_EQ(crossed, x < 0.25f ? (std::vector<uint32_t>{0, 1}) : (std::vector<uint32_t>{1}));
    }
}

TEST(SurfelTracer, FirstHitsHaveADistanceAndASide) {
    Surfel behind = disc_until(0);
    behind.position.z = -1;
    const auto made = SurfelTracer::create({disc_until(0.25f), behind});
    ASSERT_TRUE(made);
    const auto below = (*made)->first_hit({0.5f, 0, -3}, {0, 0, 1});
    ASSERT_TRUE(below);
    EXPECT_EQ(below->surfel, 1u);
    EXPECT_TRUE(below->back);
    EXPECT_NEAR(below->distance, 2, 1e-5);
    const glm::vec3 aslant(0, 0.6f, -0.8f);
    const auto above = (*made)->first_hit({0, -0.6f, 0.8f}, aslant);
    ASSERT_TRUE(above);
    EXPECT_EQ(above->surfel, 0u);
    EXPECT_FALSE(above->back);
    EXPECT_NEAR(above->distance, 1, 1e-5);
    EXPECT_FALSE((*made)->first_hit({0, 0, 1}, {0, 0, 1}));
}

TEST(SurfelTracer, LinesOfDiscsThatWereLeftOutDoNotMoveTheOthers) {
    Surfel bare = disc_until(0.5f);
    bare.normal = glm::vec3(0.0f);
    const auto made = SurfelTracer::create({bare, disc_until(0), bare, disc_until(0.25f)});
    ASSERT_TRUE(made);
    ASSERT_EQ((*made)->surfels().size(), 2u);
    size_t crossed = 0;
    (*made)->each_crossed({0.4f, 0, 1}, {0, 0, -1}, 0, 2, [&](uint32_t) { ++crossed; });
    EXPECT_EQ(crossed, 1u);
}

}  // namespace
}  // namespace lucarne::gi::tracing
