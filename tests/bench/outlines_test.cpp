#include "tests/bench/outlines.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace lucarne::bench {
namespace {

constexpr uint32_t kSide = 128;
constexpr double kSpacing = 20;  // pixels

/// Two surfaces that meet at a column of pixels.
struct Views {
    std::vector<TrueView::Pixel> truth;
    std::vector<glm::vec4> shown;
};

/// `shift`: of what the scan shows, pixels. Left of the column lies the first surface.
Views views(const TrueView::Pixel& first, const TrueView::Pixel& second, uint32_t shift) {
    Views made;
    for (size_t i = 0; i < size_t{kSide} * kSide; ++i) {
        made.truth.push_back(i % kSide < kSide / 2 ? first : second);
        const TrueView::Pixel& shown = i % kSide < kSide / 2 + shift ? first : second;
        made.shown.emplace_back(glm::vec3(shown.normal), shown.depth);
    }
    return made;
}

Outlines judged(
    const Views& views,
    const std::function<bool(size_t, double)>& scanned = [](size_t, double) { return true; }) {
    return OutlineJudge(
               views.truth, views.shown, kSide, .001, [](size_t) { return kSpacing; }, scanned)
        .judge();
}

TEST(Outlines, StepsOfDepthMayBeShiftedByHalfASpacing) {
    const TrueView::Pixel near{2, glm::dvec3(0, 0, 1)}, far{6, glm::dvec3(0, 0, 1)};
    for (const uint32_t shift : {0u, 5u, 10u, 11u, 30u}) {
        const Outlines found = judged(views(near, far, shift));
        EXPECT_EQ(found.steps.all, kSide - 2) << "all rows but the outermost";
        EXPECT_EQ(found.steps.kept, shift <= 10 ? kSide - 2 : 0) << shift;
        EXPECT_EQ(found.creases.all, 0);
    }
    EXPECT_EQ(judged(views(far, near, 0)).steps.kept, kSide - 2);
    EXPECT_EQ(judged(views(near, {0, glm::dvec3(0.0)}, 10)).steps.kept, kSide - 2) << "before the sky";
}

TEST(Outlines, CreasesMayBeShiftedByAQuarterOfASpacing) {
    const TrueView::Pixel wall{3, glm::dvec3(1, 0, 0)}, floor{3, glm::dvec3(0, 0, 1)};
    for (const uint32_t shift : {0u, 5u, 6u}) {
        const Outlines found = judged(views(wall, floor, shift));
        EXPECT_EQ(found.creases.all, kSide - 2);
        EXPECT_EQ(found.creases.kept, shift <= 5 ? kSide - 2 : 0) << shift;
        EXPECT_EQ(found.steps.all, 0);
    }
}

TEST(Outlines, WhatTheScanLacksIsLeftOut) {
    const TrueView::Pixel wall{3, glm::dvec3(1, 0, 0)}, floor{3, glm::dvec3(0, 0, 1)};
    Views none = views(wall, floor, 0);
    for (glm::vec4& pixel : none.shown) pixel = glm::vec4(0.0f);
    EXPECT_EQ(judged(none).creases.all, 0);
    // No scanner saw the wall, so the floor seems to go on: at the foot of the wall it is as far away.
    const Views open = views(wall, floor, 0);
    EXPECT_EQ(judged(open, [](size_t pixel, double) { return pixel % kSide >= kSide / 2; }).creases.all, 0);
}

TEST(Outlines, PointsOfAPlaneAreFoundNearAPlace) {
    std::vector<gi::Surfel> surfels(1);
    surfels[0].position = glm::vec3(1.02f, 2, 3);
    surfels[0].normal = glm::vec3(0, 0, -1);
    surfels[0].radius = .01f;
    surfels[0].area = .0004f;
    const SpacingMap map(surfels);
    const glm::dvec3 place(1, 2, 3), up(0, 0, 1);
    EXPECT_NEAR(map.at(place), .02, 1e-6);
    EXPECT_TRUE(map.has_point(place, up, .03));
    EXPECT_FALSE(map.has_point(place, up, .01));
    EXPECT_FALSE(map.has_point(place, {1, 0, 0}, .03));
    EXPECT_EQ(map.at({1.5, 2, 3}), 0);
}

}  // namespace
}  // namespace lucarne::bench
