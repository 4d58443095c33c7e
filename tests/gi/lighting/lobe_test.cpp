#include "gi/shared/lobe.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

/// Returns the flux of a lobe through a plane across its axis for each unit of its light.
double flux(const glm::vec3& light, const glm::vec3& directions) {
    constexpr int kSteps = 20000;
    const glm::vec3 axis = glm::normalize(directions);
    const glm::vec3 side = glm::normalize(glm::cross(axis, glm::vec3(0.3f, 0.9f, 0.1f)));
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = M_PI / 2 * (i + .5) / kSteps;
        const glm::vec3 to =
            static_cast<float>(std::cos(angle)) * axis + static_cast<float>(std::sin(angle)) * side;
        sum += lobe_radiance(light, directions, to) * std::cos(angle) * std::sin(angle) * 2 * M_PI * M_PI /
               2 / kSteps;
    }
    return sum;
}

/// The sum of directions of one surfel's lobe.
glm::vec3 directions_of(const glm::vec3& light, const glm::vec3& axis, float exponent) {
    return axis * (lobe_mean_cosine(exponent) * (light.x + light.y + light.z) / 3);
}

TEST(Lobe, IsThatOfTheBrdf) {
    const glm::vec3 light(3, 2, 1), normal(0, 0, 1), from = glm::normalize(glm::vec3(-1, 0, 1));
    const glm::vec3 mirror = glm::normalize(glm::vec3(1, 0, 1));
    for (const float exponent : {1.0f, 10.0f, 100.0f, 1000.0f}) {
        const Reflectance r{.kd = glm::vec3(0.0f), .ks = 1, .exponent = exponent};
        for (const float turn : {0.0f, 0.02f, 0.1f, 0.5f}) {
            const glm::vec3 to = glm::normalize(mirror + glm::vec3(0, turn, 0));
            const float expected = specular_brdf(r, normal, from, to);
            EXPECT_NEAR(lobe_radiance(light, directions_of(light, mirror, exponent), to), expected,
                        1e-6 + 2e-3 * expected)
                << exponent << " " << turn;
        }
    }
}

TEST(Lobe, MeanOfSeveralHasAllOfTheirLightAndIsWider) {
    const glm::vec3 light(1.0f), a = glm::normalize(glm::vec3(0.1f, 0, 1)),
                                 b = glm::normalize(glm::vec3(-0.1f, 0, 1));
    const glm::vec3 directions = directions_of(light, a, 1000) + directions_of(light, b, 1000);
    EXPECT_NEAR(flux(2.0f * light, directions), 1, 2e-3);
    const float exponent = lobe_exponent(0.5f * glm::length(directions));
    EXPECT_GT(exponent, 50);
    EXPECT_LT(exponent, 300);
}

TEST(Lobe, HalfSpaceIsTheWidest) {
    EXPECT_EQ(lobe_exponent(0.1f), 0);
    EXPECT_EQ(lobe_exponent(0), 0);
    EXPECT_NEAR(lobe_exponent(1), kLargestLobeExponent, 2e3);
    EXPECT_EQ(lobe_radiance(glm::vec3(1.0f), glm::vec3(0.0f), glm::vec3(0, 0, 1)), 0);
}

}  // namespace
}  // namespace lucarne::gi
