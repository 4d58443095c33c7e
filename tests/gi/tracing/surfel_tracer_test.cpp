#include "gi/tracing/surfel_tracer.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/tracing/light_sampling.h"

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

// A pixel may show a disc of a lower layer beside the line of one above it. It was black.
TEST(SurfelTracer, RaysStartAboveANearLayerOfTheSameSurfaceAndNotAboveOtherThings) {
    const glm::vec3 point(0.2f, 0, 0), aslant = glm::normalize(glm::vec3(0.8f, 0, 0.6f));
    const auto start_below = [&](float height, const glm::vec3& normal) {
        Surfel over = disc_until(0.25f);
        over.position.z = height;
        over.normal = normal;
        const auto made = SurfelTracer::create({disc_until(0), over});
        EXPECT_TRUE(made);
        // The point is seen aslant, past the line of the disc over it.
        return before_what_hides(**made, offset_origin(point, {0, 0, 1}, 1e-4f), aslant, {0, 0, 1}, 0.5f).z;
    };
    EXPECT_GT(start_below(0.3f, {0, 0, 1}), 0.3f);
    EXPECT_GT(start_below(0.3f, {0, 0, -1}), 0.3f) << "normals of scans may be turned";
    EXPECT_LT(start_below(2.1f, {0, 0, 1}), 0.01f) << "a shelf";
    EXPECT_LT(start_below(0.3f, glm::normalize(glm::vec3(0, 1, 0.5f))), 0.01f) << "a thing that leans";
}

TEST(SurfelTracer, DiscsEndAtTheirRims) {
    for (const glm::vec3& facing : {glm::vec3(0, 0, 1), {0, 0, -1}, {1, 0, 0}, {.3f, -.8f, .5f}}) {
        Surfel disc = disc_until(0);
        disc.position = {7, -2, 3};
        disc.normal = glm::normalize(facing);
        disc.radius = .25f;
        const auto made = SurfelTracer::create({disc});
        ASSERT_TRUE(made);
        glm::vec3 u, v;
        frame_of(disc.normal, u, v);
        for (int i = 0; i < 24; ++i) {
            const float angle = static_cast<float>(i) * static_cast<float>(M_PI / 12);
            const glm::vec3 outward = disc.radius * (std::cos(angle) * u + std::sin(angle) * v);
            for (const glm::vec3& along : {disc.normal, -disc.normal}) {
                const glm::vec3 inside = disc.position + .999f * outward,
                                outside = disc.position + 1.001f * outward;
                const auto hit = (*made)->first_hit(inside - along, along);
                ASSERT_TRUE(hit) << "at " << i;
                EXPECT_NEAR(hit->distance, 1, 1e-5);
                EXPECT_EQ(hit->back, glm::dot(along, disc.normal) > 0);
                EXPECT_TRUE((*made)->occluded(inside - along, inside + along));
                EXPECT_FALSE((*made)->occluded(outside - along, outside + along)) << "at " << i;
                EXPECT_FALSE((*made)->first_hit(outside - along, along));
            }
        }
    }
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
