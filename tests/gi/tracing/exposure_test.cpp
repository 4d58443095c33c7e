#include "gi/tracing/exposure.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gi/shared/brdf.h"
#include "io/core/random.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::tracing {
namespace {

struct ExposedAreas {
    double front = 0, back = 0;  ///< m^2
};
ExposedAreas exposed(const std::vector<Surfel>& surfels, size_t first, size_t last) {
    const auto tracer = SurfelTracer::create(surfels);
    EXPECT_TRUE(tracer);
    const auto exposure = exposures(**tracer);
    ExposedAreas sum;
    for (size_t i = first; i < last; ++i) {
        const double point = kPi * surfels[i].radius * surfels[i].radius / kExposurePoints;
        sum.front += point * exposure[i].front.points;
        sum.back += point * exposure[i].back.points;
    }
    return sum;
}

TEST(Exposure, OfASheetAddsUpToItsAreaWhateverItsNoiseAndItsShares) {
    for (const float noise : {0.0f, 0.25f, 1.0f})  // in radii
        for (const float coverage : {1.7f, 5.0f}) {
            std::vector<Surfel> sheet;
            scenes::add_rectangle(sheet, kO, 2.0f * kX, 2.0f * kY, 80, glm::vec3(0.5f));
            Random random(3);
            for (Surfel& s : sheet) {
                s.radius *= std::sqrt(coverage / scenes::kLatticeCoverage);
                s.position.z += s.radius * noise * (static_cast<float>(random.uniform()) - 0.5f);
                s.area *= 5;
            }
            const ExposedAreas areas = exposed(sheet, 0, sheet.size());
            const double with_rim = std::pow(2 + 2 * sheet[0].radius, 2);
            for (const double area : {areas.front, areas.back}) {
                EXPECT_GT(area, 4 * .98) << noise << " " << coverage;
                EXPECT_LT(area, with_rim * 1.02) << noise << " " << coverage;
            }
        }
}

TEST(Exposure, ASheetJustBelowAnotherHasItsBackAlone) {
    std::vector<Surfel> sheets;
    scenes::add_rectangle(sheets, kO, kX, kY, 40, glm::vec3(0.5f));
    const size_t lower = sheets.size();
    scenes::add_rectangle(sheets, {0, 0, sheets[0].radius}, kX, kY, 40, glm::vec3(0.5f));
    const ExposedAreas below = exposed(sheets, 0, lower), above = exposed(sheets, lower, sheets.size());
    EXPECT_LT(below.front, .01);
    EXPECT_GT(below.back, .98);
    EXPECT_GT(above.front, .98);
    EXPECT_LT(above.back, .01);

    const auto tracer = SurfelTracer::create(sheets);
    ASSERT_TRUE(tracer);
    const auto exposure = exposures(**tracer);
    for (size_t i = 0; i < sheets.size(); ++i) {
        const bool is_lower = i < lower;
        const Exposure& covered = is_lower ? exposure[i].front : exposure[i].back;
        if (covered.points > 0) continue;
        EXPECT_EQ(covered.cover % 2, is_lower ? 0u : 1u) << "the side that looks out";
        EXPECT_EQ(covered.cover / 2 < lower, !is_lower);
    }
}

TEST(Exposure, WhatOfADiscLiesBehindAWallIsNotExposed) {
    std::vector<Surfel> room;
    scenes::add_rectangle(room, kO, kX, kY, 40, glm::vec3(0.5f));
    const size_t floor = room.size();
    for (const glm::vec3& corner : {kO, kX})
        scenes::add_rectangle(room, corner - kY - kZ, 3.0f * kY, 3.0f * kZ, 120, glm::vec3(0.5f));
    for (const glm::vec3& corner : {kO, kY})
        scenes::add_rectangle(room, corner - kX - kZ, 3.0f * kX, 3.0f * kZ, 120, glm::vec3(0.5f));
    const ExposedAreas areas = exposed(room, 0, floor);
    EXPECT_NEAR(areas.front, 1, .025);
    EXPECT_NEAR(areas.back, 1, .025);
}

TEST(Exposure, WhatLiesFarBelowADiscsLineDoesNotCoverIt) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kZ, 0.1f * kX, 0.1f * kY, 1, glm::vec3(0.5f));
    surfels[0].edge = kX / (0.1f * surfels[0].radius);
    scenes::add_rectangle(surfels, -kX - kY, 3.0f * kX, 3.0f * kY, 60, glm::vec3(0.5f));
    const auto tracer = SurfelTracer::create(surfels);
    ASSERT_TRUE(tracer);
    const Exposures board = exposures(**tracer)[0];
    EXPECT_LT(board.front.points + board.back.points, 2 * kExposurePoints) << "its line is no line";
    EXPECT_EQ(board.front.cover, kUncovered);
    EXPECT_EQ(board.back.cover, kUncovered);
}

}  // namespace
}  // namespace lucarne::gi::tracing
