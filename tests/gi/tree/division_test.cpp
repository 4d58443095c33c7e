#include "gi/tree/division.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "gi/shared/brdf.h"
#include "gi/shared/frame.h"
#include "gi/tree/coverage.h"
#include "gi/tree/disc_bounds.h"
#include "gi/tree/surfel_tree.h"
#include "io/core/random.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi {
namespace {

FlatSurfel surfel_at(const glm::vec3& position) {
    FlatSurfel surfel = flat::noisy_room(1).front();
    surfel.x = position.x, surfel.y = position.y, surfel.z = position.z;
    return surfel;
}

std::vector<FlatSurfel> square(int side) {
    std::vector<FlatSurfel> surfels;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) surfels.push_back(surfel_at(glm::vec3(x, y, 0)));
    return surfels;
}

TEST(Division, PartsOfASquareHaveTheSameSizeAndEverySurfelOnce) {
    auto placed = place_surfels(square(64));
    const Parts parts = divide(placed, {0, placed.size()}, 0);
    ASSERT_EQ(parts.count, 8u);
    std::set<uint32_t> seen;
    for (size_t k = 0; k < parts.count; ++k) {
        EXPECT_EQ(parts.ranges[k].count(), 512u) << k;
        EXPECT_EQ(parts.ranges[k].first, 512 * k);
    }
    for (const PlacedSurfel& s : placed) seen.insert(s.index);
    EXPECT_EQ(seen.size(), 64u * 64);
}

TEST(Division, FewSurfelsBecomeFullNodes) {
    auto placed = place_surfels(square(7));
    const Parts parts = divide(placed, {0, placed.size()}, 0);
    ASSERT_EQ(parts.count, 7u);
    size_t full = 0;
    for (size_t k = 0; k < parts.count; ++k) full += parts.ranges[k].count() == 8;
    EXPECT_EQ(full, 6u);
}

// Halves of lengths would cut off one surfel at a time here.
TEST(Division, EndsForSurfelsThatCrowdTowardsAPoint) {
    std::vector<FlatSurfel> surfels;
    for (int i = 0; i < 4000; ++i)
        surfels.push_back(surfel_at(glm::vec3(std::ldexp(1.0f, -(i % 120)), std::ldexp(1.0f, -(i % 97)), 0)));
    const SurfelTree tree = build_tree(surfels);
    EXPECT_EQ(tree.leaves, surfels.size());
    EXPECT_LE(tree.levels.size(), kMedianLevel + 16);
}

TEST(Coverage, GapsOfOnePointCloseAndHolesStay) {
    // Discs at all points of the grid but some.
    const auto covered = [](auto left_out) {
        Coverage coverage(2, glm::vec3(0.0f), glm::vec3(8, 8, 0), glm::vec3(0.0f), glm::vec3(0, 0, 1));
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i)
                if (!left_out(i, j))
                    coverage.add(glm::vec3(static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f, 0),
                                 0.3f, glm::vec3(0, 0, 1), glm::vec3(0.0f));
        return coverage;
    };
    EXPECT_EQ(covered([](int i, int j) { return i == 3 && j == 5; }).closed(), ~uint64_t{0});
    EXPECT_EQ(covered([](int i, int j) { return i == 0 && j == 5; }).closed(), ~uint64_t{0});
    for (const Coverage& open :
         {covered([](int i, int j) { return i / 2 == 1 && j / 2 == 2; }),
          covered([](int i, int) { return i > 4; }), covered([](int i, int j) { return i == 0 && j == 0; })})
        EXPECT_EQ(open.closed(), open.covered());
}

// The masks of nodes follow from it.
TEST(Coverage, CoversWhatIsAskedForOnlyIfNoPointOfItIsOpen) {
    Coverage coverage(1, glm::vec3(0.0f), glm::vec3(8, 0, 8), glm::vec3(0.0f), glm::vec3(0, 1, 0));
    for (int z = 0; z < 8; ++z)
        for (int x = 0; x < 8; ++x)
            if (x != 6 || z != 2)
                coverage.add(glm::vec3(static_cast<float>(x) + 0.5f, 0, static_cast<float>(z) + 0.5f), 0.3f,
                             glm::vec3(0, 1, 0), glm::vec3(0.0f));
    EXPECT_FALSE(coverage.covers([](const glm::vec3&) { return true; }));
    EXPECT_FALSE(coverage.covers([](const glm::vec3& p) { return p.x > 6 && p.z < 3; }));
    EXPECT_TRUE(coverage.covers([](const glm::vec3& p) { return p.x < 6; }));
    EXPECT_TRUE(coverage.covers([](const glm::vec3& p) { return p.z > 3; }));
}

// Discs turned out of the plane cover less of it along one axis alone, whichever axis the grid lies across.
TEST(Coverage, DiscsSeenAtAnAngleAreNarrowAlongTheirTilt) {
    for (int w = 0; w < 3; ++w) {
        const int u = (w + 1) % 3, v = (w + 2) % 3;
        glm::vec3 high(0.0f), middle(0.0f), normal(0.0f);
        high[u] = high[v] = 8;
        middle[u] = middle[v] = 4;
        normal[u] = 0.8f;
        normal[w] = 0.6f;
        glm::vec3 axis(0.0f);
        axis[w] = 1;
        Coverage coverage(w, glm::vec3(0.0f), high, glm::vec3(0.0f), axis);
        coverage.add(middle, 3, normal, glm::vec3(0.0f));
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) {
                const float x = static_cast<float>(i) - 3.5f, y = static_cast<float>(j) - 3.5f;
                const bool inside = x * x / 0.36f + y * y <= 9;
                EXPECT_EQ((coverage.covered() >> (8 * j + i) & 1) != 0, inside) << w << ' ' << i << ' ' << j;
            }
    }
}

TEST(Coverage, DiscCoversNothingBeyondItsLine) {
    Coverage coverage(2, glm::vec3(0.0f), glm::vec3(8, 8, 0), glm::vec3(0.0f), glm::vec3(0, 0, 1));
    coverage.add({4, 4, 0}, 20, {0, 0, 1}, glm::vec3(-1, 0, 0));  // ends at x = 3
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i)
            EXPECT_EQ((coverage.covered() >> (8 * j + i) & 1) != 0, i >= 3) << i << ' ' << j;
}

// The bounds hold every point of the disc, and touch it on every side.
TEST(DiscBounds, AreThoseOfTheDiscUpToItsLine) {
    Random random(3);
    const auto number = [&] { return static_cast<float>(2 * random.uniform() - 1); };
    for (int i = 0; i < 200; ++i) {
        glm::vec3 normal(number(), 0, 0), along, across;
        normal.y = number();
        normal.z = number();
        normal = glm::normalize(normal);
        frame_about(normal, along, across);
        const float radius = 1.5f + number(), turn = kPi * number(), distance = 1.05f + number();
        const glm::vec3 edge =
            i % 4 == 0 ? glm::vec3(0.0f) : (std::cos(turn) * along + std::sin(turn) * across) / distance;
        const DiscBounds bounds = disc_bounds(normal, radius, edge);
        glm::vec3 low(0.0f), high(0.0f);
        constexpr int kSteps = 200;
        for (int j = 0; j < kSteps; ++j)
            for (int k = 0; k <= kSteps; ++k) {
                const float angle = 2 * kPi * static_cast<float>(j) / kSteps;
                const glm::vec3 p = radius * static_cast<float>(k) / kSteps *
                                    (std::cos(angle) * along + std::sin(angle) * across);
                if (glm::dot(edge, p) > 1) continue;
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(bounds.low[axis], low[axis] + 1e-5f) << i;
            EXPECT_GE(bounds.high[axis], high[axis] - 1e-5f) << i;
            EXPECT_NEAR(bounds.low[axis], low[axis], 0.03f * radius) << i;
            EXPECT_NEAR(bounds.high[axis], high[axis], 0.03f * radius) << i;
        }
    }
}

}  // namespace
}  // namespace lucarne::gi
