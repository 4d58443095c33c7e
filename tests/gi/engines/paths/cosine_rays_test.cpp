#include "gi/engines/paths/cosine_rays.h"

#include <array>
#include <cmath>
#include <limits>

#include "gi/shared/brdf.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

using scenes::add_rectangle, scenes::closed_box;

TEST(CosineRays, HaveTheDensityOfTheCosine) {
    // Means over the density cos / pi: of cos^k 2 / (k + 2), of a direction along the surface 0.
    const glm::vec3 normal = glm::normalize(glm::vec3(.3f, -.8f, .5f));
    constexpr uint32_t kCount = 4096;
    glm::dvec3 sum(0.0);
    double squares = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
        const glm::vec3 direction = cosine_direction(normal, even_point(i, 7, 3));
        EXPECT_NEAR(glm::length(direction), 1, 1e-5);
        EXPECT_GE(glm::dot(direction, normal), -1e-6);
        sum += glm::dvec3(direction) / double{kCount};
        squares += std::pow(glm::dot(direction, normal), 2) / kCount;
    }
    EXPECT_NEAR(glm::dot(sum, glm::dvec3(normal)), 2. / 3, .002);
    EXPECT_NEAR(glm::length(sum - glm::dvec3(normal) * glm::dot(sum, glm::dvec3(normal))), 0, .002);
    EXPECT_NEAR(squares, .5, .002);
}

TEST(CosineRays, CrossSectionsOfAllRaysCoverWhatTheySee) {
    // Of the hemisphere above a floor a plate sees its solid angle; the rays' cross sections over the squares
    // of their distances add up to that.
    std::vector<Surfel> surfels;
    add_rectangle(surfels, kO - 2.0f * kX - 2.0f * kY + 1.0f * kZ, 4.0f * kY, 4.0f * kX, 200, glm::vec3(.5f));
    const Surfaces surfaces = surfaces_of(surfels);
    const RayStart start{kO, kZ, 1e-4f};
    constexpr uint32_t kCount = 4096;
    double angle = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
        float distance = 0;
        const RayHit hit =
            follow(surfaces, start, cosine_direction(kZ, even_point(i, 1, 2)), kCount, distance);
        if (hit.side == kNone) {
            EXPECT_EQ(distance, std::numeric_limits<float>::infinity());
            continue;
        }
        EXPECT_EQ(hit.side % 2, 0u) << "the plate's normal points down, to the start of the ray";
        angle += std::pow(hit.width / distance, 2);
    }
    const double a = 2, d = 1;  // half the plate's edge, and its distance
    const double truth = 4 * std::asin(a * a / (a * a + d * d));
    EXPECT_NEAR(angle / truth, 1, .01);
}

TEST(CosineRays, HarmonicMeanOfDistancesIsThatOfAPlane) {
    std::vector<Surfel> surfels;
    add_rectangle(surfels, kO - 20.0f * kX - 20.0f * kY + .5f * kZ, 40.0f * kY, 40.0f * kX, 300,
                  glm::vec3(.5f));
    const Surfaces surfaces = surfaces_of(surfels);
    std::vector<RayHit> hits(1024);
    // 1 / distance = cos / d: its mean is 2 / (3 d).
    EXPECT_NEAR(trace_rays(surfaces, {kO, kZ, 1e-4f}, 1, 2, hits), 1.5 * .5, .01);
    std::vector<RayHit> none(64);
    EXPECT_GT(trace_rays(surfaces, {kO, -kZ, 1e-4f}, 1, 2, none), 1e6);
}

TEST(CosineRays, FindTheFormFactorOfACubesFaces) {
    // Rays start a radius above their surfels, so these have to be small.
    constexpr uint32_t kOfAFace = 200 * 200;
    const Surfaces surfaces = surfaces_of(closed_box(1, 200, glm::vec3(.5f)));
    uint64_t ceiling = 0, walls = 0, all = 0;
    std::vector<RayHit> hits(8);
    for (Side side = 0; side < 2 * kOfAFace; side += 2) {  // the front sides of the floor
        trace_rays(surfaces, start_at(surfaces.surfels(), side), 1, side, hits);
        for (const RayHit& hit : hits) {
            ++all;
            if (hit.side == kNone) continue;
            (hit.side / 2 / kOfAFace == 1 ? ceiling : walls) += 1;
        }
    }
    // Siegel & Howell: .199825 for opposite faces of a cube, so 1 - .199825 for the walls.
    EXPECT_NEAR(static_cast<double>(ceiling) / static_cast<double>(all), .199825, .002);
    EXPECT_NEAR(static_cast<double>(walls) / static_cast<double>(all), 1 - .199825, .002);
}

TEST(CosineRays, TellWhichAreShorterAsTheirMeanLengthDoes) {
    const Surfaces surfaces = surfaces_of(closed_box(1, 20, glm::vec3(.5f)));
    size_t shorter = 0, tested = 0;
    for (Side side = 0; side < 2 * surfaces.discs(); side += 7) {
        const RayStart start = start_at(surfaces.surfels(), side);
        std::array<RayHit, 16> hits;
        const float mean = trace_rays(surfaces, start, 1, side, hits);
        for (const float length : {.05f, .3f, .45f, .6f, 3.0f}) {
            EXPECT_EQ(are_shorter(surfaces, start, 1, side, 16, length), mean < length) << mean;
            shorter += mean < length;
            ++tested;
        }
    }
    EXPECT_GT(shorter, tested / 5);
    EXPECT_LT(shorter, tested * 4 / 5);
}

}  // namespace
}  // namespace lucarne::gi::paths
