#include "gi/lighting/lobe_cells.h"

#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/lighting/lobe_albedo.h"

namespace lucarne::gi {
namespace {

TEST(LobeAlbedo, IsTheIntegralOfTheLobe) {
    for (const float exponent : {1.0f, 7.0f, 60.0f}) {
        const LobeAlbedo albedo(exponent);
        const Reflectance surface{.kd = glm::vec3(0.0f), .ks = 1, .exponent = exponent};
        for (const float angle : {0.0f, .7f, 1.4f}) {
            const glm::vec3 to(std::sin(angle), 0, std::cos(angle));
            double sum = 0;
            constexpr int kRings = 400, kSectors = 800;
            for (int ring = 0; ring < kRings; ++ring) {
                const float height = (static_cast<float>(ring) + .5f) / kRings,
                            radius = std::sqrt(1 - height * height);
                for (int sector = 0; sector < kSectors; ++sector) {
                    const float turn = 2 * kPi * (static_cast<float>(sector) + .5f) / kSectors;
                    const glm::vec3 from(radius * std::cos(turn), radius * std::sin(turn), height);
                    sum += specular_brdf(surface, glm::vec3(0, 0, 1), from, to) * height;
                }
            }
            sum *= 2 * static_cast<double>(kPi) / (kRings * kSectors);
            EXPECT_NEAR(albedo.at(to.z), sum, .005) << exponent << " " << angle;
        }
        double mean = 0;
        for (int i = 0; i < 1000; ++i)
            mean += 2 * (i + .5) / 1e6 * albedo.at((static_cast<float>(i) + .5f) / 1e3f);
        EXPECT_NEAR(albedo.mean(), mean, 1e-5);
    }
}

TEST(DirectionCells, HoldTheDirectionsAboutTheirMiddle) {
    for (uint32_t cell = 0; cell < kDirectionCells; ++cell) {
        const glm::vec3 middle = direction_of_cell(cell);
        EXPECT_EQ(direction_cell(middle), cell);
        const glm::vec3 beside =
            glm::normalize(middle + .02f * glm::vec3(std::sin(7.0f * static_cast<float>(cell)), .5f, -.7f));
        EXPECT_EQ(direction_cell(beside), cell);
    }
    for (int i = 0; i < 1000; ++i) {
        const float height = 1 - 2 * (static_cast<float>(i) + .5f) / 1000,
                    turn = 2.4f * static_cast<float>(i);
        const float radius = std::sqrt(1 - height * height);
        const glm::vec3 direction(radius * std::cos(turn), radius * std::sin(turn), height);
        const uint32_t cell = direction_cell(direction);
        ASSERT_LT(cell, kDirectionCells);
        EXPECT_GT(glm::dot(direction, direction_of_cell(cell)), std::cos(.35f)) << cell;
    }
}

TEST(LobeCells, AreAsWideAsTheLobe) {
    const LobeCells cells;
    const glm::vec3 normal(0, 0, 1), to = glm::normalize(glm::vec3(.4f, .3f, 1));
    const glm::vec3 mirror(-to.x, -to.y, to.z);
    for (const float exponent : {6.0f, 12.0f, 28.0f, 500.0f}) {
        // Cells have about the same solid angle, but not quite: lobes are normalised by whoever uses them.
        double sum = 0, along = 0;
        const LobeCells::Lobe lobe(exponent, normal, to);
        EXPECT_NEAR(lobe.at(3.0f * mirror), 1, 1e-5f);
        for (uint32_t cell = 0; cell < kDirectionCells; ++cell) {
            const glm::vec3& from = cells.direction(cell);
            if (from.z <= 0) {
                EXPECT_EQ(lobe.at(from), 0);
            }
            sum += lobe.at(from);
            along += lobe.at(from) * glm::dot(mirror, from);
        }
        const double exact = std::min(exponent, 36.0f);  // of cos^n: (n + 1) / (n + 2), less what cells widen
        EXPECT_NEAR(along / sum, (exact + 1) / (exact + 2), .03) << exponent;
    }
}

}  // namespace
}  // namespace lucarne::gi
