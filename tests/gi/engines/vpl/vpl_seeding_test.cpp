#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "gi/engines/vpl/seeding/halton.h"
#include "tests/gi/engines/vpl/light_view.h"

namespace lucarne::gi::vpl {
namespace {

using namespace testing;

const std::vector<Material> kPlain{{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)}};

class VplSeeding : public ::testing::Test {
 protected:
    void SetUp() override {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device = std::move(*made);
    }
    std::vector<VplLight> seed(const SpotSight& light, const std::vector<GBufferTexel>& texels,
                               const std::vector<glm::vec2>& points,
                               const std::vector<Material>& materials = kPlain) {
        auto lights = seed_on(*device, light, texels, materials, points);
        EXPECT_TRUE(lights) << lights.error().line();
        return lights ? *lights : std::vector<VplLight>{};
    }
    std::unique_ptr<Device> device;
};

/// Returns the mean luminous intensity over a texel as the importance map computes it: the mean of centre
/// and corners.
double texel_intensity(const SpotSight& light, uint32_t x, uint32_t y) {
    double sum = 0;
    for (const auto& [dx, dy] :
         std::array<std::pair<float, float>, 5>{{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {.5, .5}}}) {
        const glm::vec3 ray = ray_of(light.view, static_cast<float>(x) + dx, static_cast<float>(y) + dy);
        const double cosine = -glm::normalize(ray).z, outer = light.spot.position.w,
                     inner = light.spot.direction.w;
        const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
        sum += t * t * (3 - 2 * t) / 5;
    }
    return sum * light.spot.strength.x;
}

double texel_solid_angle(const SpotSight& light, uint32_t x, uint32_t y) {
    const glm::dvec3 ray = ray_of(light.view, static_cast<float>(x) + .5f, static_cast<float>(y) + .5f);
    return 4.0 * light.view.right.x * light.view.up.y / (light.view.width * light.view.height) /
           std::pow(glm::length(ray), 3);
}

double full_flux(const SpotSight& light) {  // of the whole cone; the smoothstep at the edge has a mean of 1/2
    const double inner = light.spot.direction.w, outer = light.spot.position.w;
    return 2 * std::numbers::pi * light.spot.strength.x * (1 - inner + (inner - outer) / 2);
}

double total_flux(const std::vector<VplLight>& lights) {
    return std::accumulate(lights.begin(), lights.end(), 0.0,
                           [](double sum, const VplLight& l) { return sum + l.flux.x; });
}

TEST(VplHalton, radicalInversesMirrorTheDigits) {
    EXPECT_DOUBLE_EQ(radical_inverse(2, 0), 0);
    EXPECT_DOUBLE_EQ(radical_inverse(2, 6), 3 / 8.);          // 110 -> .011
    EXPECT_DOUBLE_EQ(radical_inverse(3, 5), 7 / 9.);          // 12 -> .21
    EXPECT_DOUBLE_EQ(radical_inverse(3, 1000), 760 / 2187.);  // 1101001 -> .1001011
}

TEST(VplShares, followTheWeightsAndAddUp) {
    const std::vector<double> weights = {6, 3, 0, 1e-9, 1};
    const auto shares = share_out(weights, 103);
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0u), 103u);
    EXPECT_EQ(shares[2], 0u);
    EXPECT_EQ(shares[3], 1u);  // little light, but no light is left out
    EXPECT_NEAR(shares[0], 60, 2);
    EXPECT_NEAR(shares[1], 30, 2);
    EXPECT_EQ(share_out(std::vector<double>{0, 0}, 8), (std::vector<uint32_t>{0, 0}));
    EXPECT_EQ(share_out(std::vector<double>{1, 1, 1}, 2), (std::vector<uint32_t>{1, 1, 0}));
}

TEST(VplHalton, everyCellOfAGridGetsItsShareForAnySeedAndFrame) {
    for (uint64_t frame = 0; frame < 4; ++frame) {
        const auto points = halton_points(1024, 7, frame);
        std::array<int, 16> counts{};
        for (const auto& p : points) {
            ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            ++counts[static_cast<size_t>(p.x * 4) + 4 * static_cast<size_t>(p.y * 4)];
        }
        for (const int count : counts)
            EXPECT_NEAR(count, 64, 8);  // a random set deviates by 8 in one of three cells
    }
    EXPECT_NE(halton_points(4, 7, 0)[3], halton_points(4, 7, 1)[3]);
    EXPECT_NE(halton_points(4, 7, 0)[3], halton_points(4, 8, 0)[3]);
    EXPECT_EQ(halton_points(4, 7, 3)[3], halton_points(4, 7, 3)[3]);
}

/// Returns Pearson's statistic as a deviate of the normal distribution (Wilson and Hilferty 1931).
double chi_square_deviate(const std::vector<double>& expected, const std::vector<int>& counts) {
    double statistic = 0, degrees = -1, rest_expected = 0, rest_count = 0;
    for (size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] < 10) {  // too few for the statistic: pool them
            rest_expected += expected[i];
            rest_count += counts[i];
            continue;
        }
        statistic += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
        ++degrees;
    }
    if (rest_expected > 10) {
        statistic += (rest_count - rest_expected) * (rest_count - rest_expected) / rest_expected;
        ++degrees;
    }
    const double width = 2 / (9 * degrees);
    return (std::cbrt(statistic / degrees) - (1 - width)) / std::sqrt(width);
}

TEST_F(VplSeeding, warpedIndependentPointsFollowTheImportanceByChiSquare) {
    constexpr uint32_t kSide = 24;  // not a power of two: the map is padded
    constexpr size_t kPoints = 60'000;
    const SpotSight light = downward_spot(kSide, .6f, .95f, 3);
    Random random(11);
    std::vector<GBufferTexel> texels;
    std::vector<double> weights, lit;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const bool empty = random.uniform() < .2;
            const auto code = static_cast<uint32_t>(random.uniform() * random.uniform() * 900);
            const float albedo = srgb_to_linear(static_cast<float>(code) / 1023);
            texels.push_back(empty ? GBufferTexel{} : floor_texel(2, albedo));
            const double intensity = empty ? 0 : texel_intensity(light, x, y);
            weights.push_back(intensity * texel_solid_angle(light, x, y) * albedo);
            lit.push_back(intensity > 0);
        }
    std::vector<glm::vec2> points;
    for (size_t i = 0; i < kPoints; ++i)
        points.emplace_back(random.uniform() * .9999999, random.uniform() * .9999999);

    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const double lit_sum = std::accumulate(lit.begin(), lit.end(), 0.0);
    std::vector<double> expected;
    for (size_t i = 0; i < weights.size(); ++i)
        expected.push_back(kPoints * (.95 * weights[i] / sum + .05 * lit[i] / lit_sum));
    std::vector<int> counts(weights.size());
    for (const VplLight& l : seed(light, texels, points)) {
        ASSERT_NE(l.normal, glm::vec4(0.0f)) << "no point may fall where there is no light";
        const float u = l.position.x / -l.position.z / light.view.right.x;
        const float v = -l.position.y / -l.position.z / light.view.up.y;
        const auto x = static_cast<size_t>((u * .5f + .5f) * kSide),
                   y = static_cast<size_t>((v * .5f + .5f) * kSide);
        ASSERT_LT(y * kSide + x, counts.size());
        ++counts[y * kSide + x];
    }
    EXPECT_LT(std::abs(chi_square_deviate(expected, counts)), 4);

    // The test is sensitive: it rejects a density without the even share.
    for (size_t i = 0; i < weights.size(); ++i) expected[i] = kPoints * weights[i] / sum;
    EXPECT_GT(chi_square_deviate(expected, counts), 10);
}

TEST_F(VplSeeding, incidentFluxOverManySeedsIsTheFluxThatLands) {
    constexpr uint32_t kSide = 128;
    const SpotSight light = downward_spot(kSide, .7f, .9f, 5);
    Random random(3);
    std::vector<GBufferTexel> whole, half;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        // From black to white: the importance differs, the flux must not.
        whole.push_back(floor_texel(3, static_cast<float>(random.uniform())));
        half.push_back(i % kSide < kSide / 2 ? whole.back() : GBufferTexel{});
    }
    constexpr int kSeeds = 64;
    double whole_sum = 0, half_sum = 0;
    for (uint64_t s = 0; s < kSeeds; ++s) {
        const auto points = halton_points(256, s, 0);
        whole_sum += total_flux(seed(light, whole, points)) / kSeeds;
        half_sum += total_flux(seed(light, half, points)) / kSeeds;
    }
    // The sum of each seed has a standard deviation of some 10 % (the albedo is noise), their mean an eighth
    // of that.
    EXPECT_NEAR(whole_sum, full_flux(light), .02 * full_flux(light));
    EXPECT_NEAR(half_sum, full_flux(light) / 2, .02 * full_flux(light));
}

TEST_F(VplSeeding, lightsLieOnTheSurfaceFaceTheSpotAndStandForTheirShareOfIt) {
    constexpr uint32_t kSide = 64;
    const SpotSight light = downward_spot(kSide, .5f, .99f, 1);
    const std::vector<GBufferTexel> floor(kSide * kSide, floor_texel(2, .5f));
    double footprints = 0;
    const auto lights = seed(light, floor, halton_points(512, 1, 0));
    for (const VplLight& l : lights) {
        EXPECT_NEAR(l.position.z, -2, 1e-5);
        EXPECT_NEAR(l.normal.z, 1, 1e-4);
        EXPECT_NEAR(glm::length(glm::vec3(l.incident)), 1, 1e-5);
        EXPECT_GT(glm::dot(glm::vec3(l.incident), -glm::vec3(l.position)), 0);
        footprints += l.position.w;
    }
    const double disc = std::numbers::pi * std::pow(2 * std::tan(.5), 2);
    EXPECT_NEAR(footprints, disc,
                .1 * disc);  // the faint rim has few samples, with large footprints
}

TEST_F(VplSeeding, shinySurfacesGetMoreLightsThanDullOnesOfTheSameReflectance) {
    constexpr uint32_t kSide = 64;
    const SpotSight light = downward_spot(kSide, .5f, .9f, 1);
    std::vector<GBufferTexel> floor;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        floor.push_back(floor_texel(2, .5f));
        floor.back().material = i % kSide < kSide / 2 ? 0 : 1;
    }
    const std::vector<Material> materials{{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)},
                                          {glm::vec4(0, 0, 0, .5), glm::vec4(0, 0, 0, 100)}};
    int dull = 0, shiny = 0;
    for (const VplLight& l : seed(light, floor, halton_points(512, 1, 0), materials))
        ++(l.position.x < 0 ? dull : shiny);
    EXPECT_GT(shiny, 3 * dull);
}

TEST_F(VplSeeding, whatSeesNoLightHasNoLights) {
    const SpotSight dark = downward_spot(32, .5f, .9f, 0), lit = downward_spot(32, .5f, .9f, 1);
    const std::vector<GBufferTexel> floor(32 * 32, floor_texel(2, .5f)), nothing(32 * 32);
    for (const auto& lights :
         {seed(dark, floor, halton_points(16, 1, 0)), seed(lit, nothing, halton_points(16, 1, 0))})
        for (const VplLight& l : lights) {
            EXPECT_EQ(l.normal, glm::vec4(0.0f));
            EXPECT_EQ(l.flux, glm::vec4(0.0f));
        }
}

TEST_F(VplSeeding, brokenDepthsGiveNoLightsThatAreNotFinite) {
    const SpotSight light = downward_spot(32, .5f, .9f, 1);
    std::vector<GBufferTexel> floor(32 * 32, floor_texel(2, .5f));
    for (size_t i = 0; i < floor.size(); i += 3) floor[i].depth = std::numeric_limits<float>::quiet_NaN();
    for (size_t i = 1; i < floor.size(); i += 3)
        floor[i].normal = encode_octahedral(glm::vec3(1, 0, 0));  // edge on
    for (const VplLight& l : seed(light, floor, halton_points(256, 1, 0)))
        for (const glm::vec4& v : {l.position, l.normal, l.diffuse, l.flux, l.incident})
            EXPECT_TRUE(std::isfinite(v.x + v.y + v.z + v.w));
}

}  // namespace
}  // namespace lucarne::gi::vpl
