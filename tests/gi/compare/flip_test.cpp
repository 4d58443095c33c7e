#include "gi/compare/flip.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <numeric>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace lucarne::gi {
namespace {

using Picture = std::vector<glm::vec4>;

struct Place {
    uint32_t x, y, width, height;
    bool second;  ///< of the pair
};

// The pairs of tests/oracles/flip_oracle.py.
glm::dvec3 ramps(const Place& p) {
    const double shade = p.second && (p.x / 8 + p.y / 8) % 2 == 0 ? 0.8 : 1.0;
    return shade * glm::dvec3(double(p.x) / p.width, double(p.y) / p.height,
                              double(p.x + p.y) / (p.width + p.height));
}

glm::dvec3 noise(const Place& p) {
    const auto value = [&](uint32_t channel) {
        uint32_t hash = ((p.y * p.width + p.x) * 3 + channel + (p.second ? 1000000u : 0u)) * 2654435761u;
        hash = (hash ^ hash >> 15) * 2246822519u;
        return (hash >> 8) / 16777216.0;
    };
    return {value(0), value(1), value(2)};
}

glm::dvec3 thin(const Place& p) {
    if (p.second && p.y == p.height / 2 && p.x == 40) return {1, 0, 0};
    return glm::dvec3(p.second && p.x == 20 ? 1.0 : 0.2);
}

glm::dvec3 extremes(const Place& p) {
    if (p.x >= p.width / 2) return glm::dvec3(p.second);
    return {0, !p.second, p.second};
}

glm::dvec3 shifted(const Place& p) {
    const double stripe = (p.x + p.second) / 4 % 2;
    return {0.1 + 0.7 * stripe, 0.3 + 0.2 * stripe, 0.5 - 0.4 * stripe};
}

using Formula = glm::dvec3 (*)(const Place&);

Picture make(Formula formula, uint32_t width, uint32_t height, bool second) {
    Picture picture;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            picture.emplace_back(glm::vec3(formula({x, y, width, height, second})), 1.0f);
    return picture;
}

double mean(const std::vector<float>& errors) {
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

TEST(Flip, AgreesWithNvidiasEvaluatorPixelByPixel) {
    const std::map<std::string, Formula> formulas = {
        {"ramps", ramps}, {"noise", noise}, {"thin", thin}, {"extremes", extremes}, {"shifted", shifted}};
    std::ifstream file(LUCARNE_SOURCE_DIR "/tests/oracles/flip_expected.json");
    const auto expected = nlohmann::json::parse(file);
    const size_t stride = expected["stride"];
    size_t compared = 0;
    for (const auto& pair : expected["pairs"]) {
        const Formula formula = formulas.at(pair["name"]);
        const uint32_t width = pair["width"], height = pair["height"];
        const auto errors =
            flip_errors(make(formula, width, height, false), make(formula, width, height, true), width);
        EXPECT_NEAR(mean(errors), pair["mean"], 2e-5) << pair["name"];
        for (size_t i = 0; i < pair["pixels"].size(); ++i, ++compared)
            // Near 0 the roots in FLIP turn the rounding of floats (1e-7) into some 1e-4.
            EXPECT_NEAR(errors[i * stride], pair["pixels"][i], 1e-3) << pair["name"] << " " << i * stride;
    }
    EXPECT_GT(compared, 80u);
}

TEST(Flip, IsZeroForEqualPicturesAndTheSameBothWays) {
    const Picture a = make(noise, 33, 9, false), b = make(noise, 33, 9, true);
    for (const float error : flip_errors(a, a, 33)) EXPECT_EQ(error, 0);
    EXPECT_EQ(flip_errors(a, b, 33), flip_errors(b, a, 33));
}

TEST(Flip, LargestDifferenceOfFlatColoursIsOne) {
    // Green and blue are farthest apart. Flat pictures test the colour term alone.
    const auto errors = flip_errors(Picture(12, {0, 1, 0, 1}), Picture(12, {0, 0, 1, 1}), 4);
    for (const float error : errors) EXPECT_NEAR(error, 1, 1e-4);
}

TEST(Flip, FromFartherAwayFineNoiseIsSeenLess) {
    const Picture a = make(noise, 40, 40, false), b = make(noise, 40, 40, true);
    EXPECT_LT(mean(flip_errors(a, b, 40, 2 * kFlipPixelsPerDegree)), mean(flip_errors(a, b, 40)));
}

TEST(Flip, PicturesSmallerThanItsFiltersWork) {
    EXPECT_GT(flip_errors(Picture(1, {1, 1, 1, 1}), Picture(1, {0, 0, 0, 1}), 1)[0], 0.5f);
    EXPECT_TRUE(flip_errors(Picture(), Picture(), 1).empty());
}

}  // namespace
}  // namespace lucarne::gi
