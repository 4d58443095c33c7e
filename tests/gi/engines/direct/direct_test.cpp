#include "gi/engines/direct/direct.h"

#include <random>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/lighting/light_options.h"
#include "gi/shared/brdf.h"
#include "gi/shared/light.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class DirectTest : public OnDevice {
 protected:
    Lit light(const std::vector<Surfel>& surfels, const CameraView& camera, const LitOptions& options) {
        const auto engine = direct_engine().make();
        return light_up(*device, *engine, SurfelCloud(surfels), camera, options);
    }
};

/// The square [-half, half]^2 at height z, facing up.
std::vector<Surfel> plate(float half, float z, int n, float albedo = 0.5f) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}, n,
                          glm::vec3(albedo));
    return surfels;
}

TEST_F(DirectTest, PlaneUnderASpotReflectsWhatTheFormulaSays) {
    LitOptions options;
    options.lights = {scenes::spot({0.5f, 0.2f, 2}, {0, 0, 0}, 0.7f, 0.7f, 30)};
    const Lit lit = light(plate(2, 0, 100), look({0, -2, 2.5f}, {0, 0, 0}, 160, 120, 0.6f), options);
    for (uint32_t y = 20; y < 100; y += 7)
        for (uint32_t x = 30; x < 130; x += 7) {
            const glm::vec3 p = lit.position(x, y), to_light = glm::vec3(0.5f, 0.2f, 2) - p;
            if (glm::length(glm::vec2(p.x, p.y)) > 0.8f) continue;  // another test: the edge
            const float d2 = glm::dot(to_light, to_light);
            const float albedo = decode_albedo(lit.texels[y * 160 + x].albedo).x;
            EXPECT_NEAR(albedo, 0.5f, 2e-3f);
            const float expected = albedo / kPi * 30 * (to_light.z / std::sqrt(d2)) / d2;
            EXPECT_NEAR(lit.at(x, y).x, expected, expected * 2e-3f) << x << " " << y;
        }
}

TEST_F(DirectTest, GlossyLobeIsAddedInTheMirrorDirection) {
    LitOptions options;
    options.lights = {scenes::spot({0, 2, 2}, {0, 0, 0}, 0.3f, 0.3f, 30)};
    options.materials = {scenes::material(1, 0.3f, 50)};
    const Lit lit = light(plate(1, 0, 100), look({0, -2, 2}, {0, 0, 0}, 101, 101, 0.2f), options);
    // In the middle the eye is in the mirror direction, so cos^n = 1.
    const float expected = (0.5f / kPi + 0.3f * 52 / (2 * kPi)) * 30 * std::sqrt(0.5f) / 8;
    EXPECT_NEAR(lit.at(50, 50).x, expected, expected * 0.01f);
}

TEST_F(DirectTest, SpotsEdgeLiesWhereItsConeEnds) {
    constexpr float kHalf = 0.4f, kHeight = 3;
    LitOptions options;
    options.lights = {scenes::spot({0, 0, kHeight}, {0, 0, 0}, kHalf, kHalf * (1 - 0.3f), 30)};
    const Lit lit = light(plate(3, 0, 150), look({0, -0.01f, 8}, {0, 0, 0}, 240, 240, 0.6f), options);
    const float outer = kHeight * std::tan(kHalf), inner = kHeight * std::tan(kHalf * 0.7f);
    size_t lit_pixels = 0, faded = 0;
    for (uint32_t y = 0; y < 240; ++y)
        for (uint32_t x = 0; x < 240; ++x) {
            const glm::vec3 p = lit.position(x, y);
            const float r = std::hypot(p.x, p.y), d = std::hypot(r, kHeight);
            const float full = 0.5f / kPi * 30 * kHeight / (d * d * d), got = lit.at(x, y).x;
            if (r > outer + 1e-3f) {
                ASSERT_EQ(got, 0.0f) << r;
            }
            if (r < inner - 1e-3f) {
                ASSERT_NEAR(got, full, full * 0.01f) << r;
            }
            if (r > inner + 0.02f && r < outer - 0.02f) {
                ASSERT_LT(got, full);
                ASSERT_GT(got, 0.0f);
                ++faded;
            }
            lit_pixels += got > 0;
        }
    EXPECT_GT(lit_pixels, 3000u);
    EXPECT_GT(faded, 1000u);
}

TEST_F(DirectTest, SquareOccluderThrowsItsShadowWhereGeometrySays) {
    constexpr float kHalf = 0.3f, kAt = 1.0f, kLight = 3.0f;
    auto surfels = plate(2, 0, 200);
    const auto occluder = plate(kHalf, kAt, 60);
    surfels.insert(surfels.end(), occluder.begin(), occluder.end());
    LitOptions options;
    options.lights = {scenes::spot({0, 0, kLight}, {0, 0, 0}, 0.5f, 0.5f, 30)};
    options.settings.set(kLightResolution, 512);
    // Seen from the side, so that the occluder does not hide its shadow.
    const Lit lit = light(surfels, look({0, -4, 1.5f}, {0, 0, 0}, 320, 240, 0.5f), options);
    const float shadow = kHalf * kLight / (kLight - kAt);
    // The tolerance: the radius of a disc at the edge of the occluder, projected on the floor; the lift of
    // the floor's points; a texel of the map.
    const float margin = (2 * 0.02f + 0.02f) * 1.5f + 0.02f;
    size_t dark = 0, bright = 0;
    for (uint32_t y = 0; y < 240; ++y)
        for (uint32_t x = 0; x < 320; ++x) {
            const glm::vec3 p = lit.position(x, y);
            if (lit.texels[y * 320 + x].depth == 0 || std::abs(p.z) > 0.01f) continue;
            const float away = std::max(std::abs(p.x), std::abs(p.y));
            if (away < shadow - margin) {
                ASSERT_EQ(lit.at(x, y), glm::vec3(0.0f)) << p.x << " " << p.y;
                ++dark;
            } else if (away > shadow + margin && std::hypot(p.x, p.y) < 1.5f) {
                const float d = std::hypot(p.x, p.y, kLight);
                const float expected = 0.5f / kPi * 30 * kLight / (d * d * d);
                ASSERT_NEAR(lit.at(x, y).x, expected, expected * 0.01f) << p.x << " " << p.y;
                ++bright;
            }
        }
    EXPECT_GT(dark, 1000u);
    EXPECT_GT(bright, 5000u);
}

TEST_F(DirectTest, CurvedNoisySurfaceHasNoAcneInTheLight) {
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, 1);
    std::vector<Surfel> ball;
    constexpr int kCount = 60000;
    const float spacing = std::sqrt(4 * kPi / kCount);
    for (int i = 0; i < kCount; ++i) {  // a Fibonacci lattice (Gonzalez 2010)
        const float z = 1 - 2 * (static_cast<float>(i) + .5f) / kCount, a = static_cast<float>(i) * 2.399963f;
        const float r = std::sqrt(1 - z * z);
        const glm::vec3 n(r * std::cos(a), r * std::sin(a), z);
        ball.push_back(
            {n * (1 + 0.25f * spacing * noise(random)), n, glm::vec3(0.5f), 0, spacing * spacing, 0});
    }
    LitOptions options;
    options.lights = {scenes::spot({0, -4, 0}, {0, 0, 0}, 0.3f, 0.3f, 30)};
    const Lit lit = light(ball, look({0.5f, -4, 0.5f}, {0, 0, 0}, 240, 240, 0.55f), options);
    size_t seen = 0;
    for (uint32_t y = 0; y < 240; ++y)
        for (uint32_t x = 0; x < 240; ++x) {
            const GBufferTexel& texel = lit.texels[y * 240 + x];
            // At the limb the camera sees the backs of discs that turn away from it, whose light is
            // shadowed.
            if (texel.depth == 0 || glm::dot(decode_octahedral(texel.normal), lit.position(x, y)) < 0)
                continue;
            const glm::vec3 to_light = glm::vec3(0, -4, 0) - lit.position(x, y);
            const float d2 = glm::dot(to_light, to_light);
            const float cosine = glm::dot(decode_octahedral(texel.normal), to_light) / std::sqrt(d2);
            if (cosine < 0.2f) continue;  // at the terminator the shadow of half a disc is correct
            const float expected = 0.5f / kPi * 30 * cosine / d2;
            ASSERT_NEAR(lit.at(x, y).x, expected, expected * 0.01f) << x << " " << y << " cosine " << cosine;
            ++seen;
        }
    EXPECT_GT(seen, 10000u);
}

TEST_F(DirectTest, SealedBoxStaysBlackInside) {
    std::vector<Surfel> box = scenes::closed_box(2, 60, glm::vec3(0.8f));
    for (Surfel& s : box) s.position -= glm::vec3(1);
    LitOptions options;
    options.lights = {scenes::spot({0.3f, 0.2f, 4}, {0, 0, 0}, 0.6f, 0.6f, 1000),
                      scenes::spot({4, 3, 0.4f}, {0, 0, 0}, 0.6f, 0.6f, 1000)};
    for (const glm::vec3 to :
         {glm::vec3(1, 0.3f, 0.9f), glm::vec3(-1, 0.5f, -0.5f), glm::vec3(0.2f, 0.1f, -1)}) {
        const Lit lit = light(box, look({0.1f, 0.1f, 0.1f}, to, 160, 120, 1.6f), options);
        for (const glm::vec4& v : lit.radiance) ASSERT_EQ(glm::vec3(v.x, v.y, v.z), glm::vec3(0.0f));
    }
}

TEST_F(DirectTest, LightInsideABoxDoesNotLeaveIt) {
    std::vector<Surfel> surfels = scenes::closed_box(1, 40, glm::vec3(0.8f));
    for (Surfel& s : surfels) s.position -= glm::vec3(0.5f);
    const auto floor = plate(3, -0.6f, 150);
    surfels.insert(surfels.end(), floor.begin(), floor.end());
    LitOptions options;
    options.lights = {scenes::spot({0, 0, 0.2f}, {0, 0, -1}, 1.2f, 1.2f, 1000)};
    const Lit lit = light(surfels, look({0, -4, 2}, {0, 0, -0.5f}, 160, 120, 0.8f), options);
    for (const glm::vec4& v : lit.radiance) ASSERT_EQ(glm::vec3(v.x, v.y, v.z), glm::vec3(0.0f));
}

TEST_F(DirectTest, LightsAddUp) {
    const auto surfels = plate(2, 0, 60);
    const CameraView camera = look({0, -2, 2.5f}, {0, 0, 0}, 80, 60, 0.6f);
    const Light a = scenes::spot({0.5f, 0.2f, 2}, {0, 0, 0}, 0.7f, 0.7f, 30);
    const Light b = scenes::spot({-0.5f, 0.6f, 1}, {0, 0, 0}, 0.5f, 0.5f, 10);
    LitOptions options;
    options.lights = {a};
    const Lit first = light(surfels, camera, options);
    options.lights = {b};
    const Lit second = light(surfels, camera, options);
    options.lights = {a, b};
    const Lit both = light(surfels, camera, options);
    for (size_t i = 0; i < both.radiance.size(); ++i)
        ASSERT_NEAR(both.radiance[i].x, first.radiance[i].x + second.radiance[i].x, 1e-5f);
}

TEST_F(DirectTest, WithoutLightsOnlyEmissionAndBackgroundAreSeen) {
    LitOptions options;
    options.materials = {scenes::material(1, 0, 1, 2.5f)};
    options.background = {0.1f, 0.2f, 0.3f};
    const Lit lit = light(plate(0.5f, 0, 30), look({0, -2, 2}, {0, 0, 0}, 80, 60, 1.0f), options);
    size_t surface = 0;
    for (size_t i = 0; i < lit.radiance.size(); ++i) {
        const glm::vec3 v(lit.radiance[i].x, lit.radiance[i].y, lit.radiance[i].z);
        surface += lit.texels[i].depth > 0;
        ASSERT_EQ(v, lit.texels[i].depth > 0 ? glm::vec3(2.5f) : options.background);
    }
    EXPECT_GT(surface, 100u);
    options.settings.set(kOnlyBounce, 1);
    const Lit none = light(plate(0.5f, 0, 30), look({0, -2, 2}, {0, 0, 0}, 80, 60, 1.0f), options);
    for (const glm::vec4& v : none.radiance) ASSERT_EQ(v.x, 0.0f) << "direct light has no first bounce";
}

TEST_F(DirectTest, BadSceneNeverGivesANumberThatIsNone) {
    auto surfels = plate(1, 0, 20, 1.0f);   // an albedo of 1
    surfels[3].area = surfels[4].area = 0;  // no radius
    surfels[5].normal = glm::vec3(0.0f);
    surfels[6].material = 255;  // no such material
    LitOptions options;
    options.materials = {scenes::material(5, 2, 0)};  // kd + ks far above 1, no exponent
    options.lights = {scenes::spot({0, 0, 0}, {0, 0, -1}, 1.2f, 1.2f, 30),  // in the plane of the wall
                      scenes::spot({0, 0, 1}, {0, 0, 0}, 1.7f, 1.7f, 30),   // wider than a half space
                      scenes::spot({0, 0, 1}, {0, 0, 0}, 0.5f, 0.5f, 0)};   // dark
    const Lit lit = light(surfels, look({0, -2, 2}, {0, 0, 0}, 80, 60, 1.0f), options);
    for (const glm::vec4& v : lit.radiance) {
        ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
        ASSERT_GE(std::min({v.x, v.y, v.z}), 0.0f);
    }
}

TEST_F(DirectTest, NoSurfelsGiveTheBackground) {
    LitOptions options;
    options.lights = {scenes::spot({0, 0, 2}, {0, 0, 0}, 0.5f, 0.5f, 30)};
    options.background = glm::vec3(0.5f);
    const Lit lit = light({}, look({0, -2, 2}, {0, 0, 0}, 40, 30), options);
    for (const glm::vec4& v : lit.radiance) ASSERT_EQ(v.x, 0.5f);
}

TEST(Brdf, ReflectsNoMoreThanArrives) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    const glm::vec3 normal(0, 0, 1), from = glm::normalize(glm::vec3(1, 0, 1));
    for (const float ks : {0.0f, 0.4f, 1.0f}) {
        const Reflectance r = make_reflectance(scenes::material(1, ks, 20), glm::vec3(1.0f));
        EXPECT_LE(r.kd.x + r.ks, 1.0f);
        double sum = 0;
        constexpr int kSamples = 200000;
        for (int i = 0; i < kSamples; ++i) {  // cosine-weighted: f / (pdf / cos) = pi f
            const float u = unit(random), phi = 2 * kPi * unit(random), s = std::sqrt(u);
            sum += kPi * brdf(r, normal, from, {s * std::cos(phi), s * std::sin(phi), std::sqrt(1 - u)}).x;
        }
        const double albedo = sum / kSamples;
        EXPECT_LE(albedo, 1.01);
        EXPECT_GT(albedo, ks > 0.9f ? 0.7 : 0.85);
    }
}

TEST(Spot, FluxOfASharpConeIsIntensityTimesSolidAngle) {
    const Light spot = scenes::spot({0, 0, 0}, {0, 0, 1}, 0.6f, 0.6f, 2);
    double flux = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = 1 - 2 * (static_cast<float>(i) + .5f) / kSteps;
        flux += light_intensity(spot, {std::sqrt(1 - cosine * cosine), 0, cosine}).x * 4 * M_PI / kSteps;
    }
    EXPECT_NEAR(flux, 2 * 2 * M_PI * (1 - std::cos(0.6)), 1e-3);
}

}  // namespace
}  // namespace lucarne::gi
