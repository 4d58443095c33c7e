// The sky in every engine that does not sample it by light views.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/volume/options.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/gather_sky.h"
#include "gi/shared/luminance.h"
#include "io/core/random.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene, scenes::look;

class SkyLight : public testing::TestWithParam<const char*> {
 protected:
    static void SetUpTestSuite() {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device_ = std::move(*made);
    }
    static void TearDownTestSuite() { device_.reset(); }
    static std::vector<glm::vec4> render(const AnalyticScene& scene, const char* engine = GetParam()) {
        auto rendered = scenes::render(*device_, engine, scene);
        EXPECT_TRUE(rendered) << rendered.error().line();
        return rendered ? std::move(rendered->radiance) : std::vector<glm::vec4>{};
    }

    static std::unique_ptr<Device> device_;
};
std::unique_ptr<Device> SkyLight::device_;

void set_fine(EngineSettings& settings) {
    settings.set(kMicroBuffer, 24);
    settings.set(kGatherEvery, 1);
    settings.set(kRadiosityLevel, 12);
    settings.set(environment::kCacheSpacing, 3);
    settings.set(volume::kVoxelCount, 64);
    settings.set(volume::kSweepDirections, 256);
    settings.set(reference::kSamples, 512);
}

/// Voxels at the edges of an opening make it smaller.
double tolerance(std::string_view engine, double of_others) {
    return engine == "volume" ? 0.08 : of_others;
}

/// A room with an opening in its ceiling, seen from above the floor in a corner.
AnalyticScene room_with_skylight(std::shared_ptr<const Environment> sky) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.5f));
    std::erase_if(scene.surfels, [](const Surfel& s) {
        return s.position.z > 1.99f && std::abs(s.position.x - 1.2f) < .5f &&
               std::abs(s.position.y - 1) < .5f;
    });
    scene.environment = std::move(sky);
    scene.camera = look(glm::vec3(0.4f, 0.4f, 1.2f), glm::vec3(1.4f, 1.4f, 0.1f), 0.7f, 48);
    set_fine(scene.settings);
    return scene;
}

TEST_P(SkyLight, FloorUnderAnEvenSkyReflectsIt) {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, 2.0f * kX, 2.0f * kY, 120, glm::vec3(0.5f));
    scene.environment = scenes::even_sky(2);
    scene.camera = look(glm::vec3(1, 1, 3), glm::vec3(1, 1, 0), 0.25f, 48);
    for (const uint32_t bounces : {0u, 2u}) {
        scene.settings.set(kBounces, bounces);
        for (const glm::vec4& pixel : render(scene)) EXPECT_NEAR(pixel.x, 1, 0.01) << bounces;
    }
}

TEST_P(SkyLight, RoomUnderASkylightIsThatOfTheReference) {
    AnalyticScene scene = room_with_skylight(scenes::even_sky(1));
    if (GetParam() == std::string_view("volume")) scene.settings.set(reference::kSamples, 64);
    for (const int32_t bounce : {0, 1, 2, -1}) {
        scene.settings.set(kOnlyBounce, bounce);
        const double truth = mean_luminance(render(scene, "reference"));
        // `micro` is darkest in bounces 1 and 2: by 2.7 and 3.1 %, by 2.8 and 3.2 % if all points are drawn
        // one by one or all in groups; with other seeds bounce 1 by 2.3 to 3.4 %.
        EXPECT_NEAR(mean_luminance(render(scene)) / truth, 1, tolerance(GetParam(), 0.035)) << bounce;
    }
}

TEST_P(SkyLight, SunInThePictureOfASkyIsNotLost) {
    auto sky = std::make_shared<Environment>();
    sky->width = 64;
    sky->height = 32;
    sky->texels.assign(64 * 32, glm::vec3(0.2f));
    sky->texels[2 * 64 + 20] = glm::vec3(1000, 800, 600);
    AnalyticScene scene = room_with_skylight(sky);
    scene.settings.set(kBounces, 1);
    if (GetParam() == std::string_view("volume")) scene.settings.set(reference::kSamples, 64);
    const double truth = mean_luminance(render(scene, "reference"));
    EXPECT_NEAR(mean_luminance(render(scene)) / truth, 1, tolerance(GetParam(), 0.05));
}

TEST_P(SkyLight, SealedRoomStaysBlackUnderAnySky) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.9f));
    scene.environment = scenes::even_sky(1e4f);
    scene.camera = look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, 64);
    for (const glm::vec4& pixel : render(scene)) EXPECT_EQ(std::max({pixel.x, pixel.y, pixel.z}), 0);
}

TEST_P(SkyLight, DarkSkyIsDark) {
    const AnalyticScene scene = room_with_skylight(scenes::even_sky(0));
    for (const glm::vec4& pixel : render(scene)) EXPECT_EQ(std::max({pixel.x, pixel.y, pixel.z}), 0);
}

INSTANTIATE_TEST_SUITE_P(Gathering, SkyLight, testing::Values("micro", "environment", "volume"),
                         [](const auto& engine) { return std::string(engine.param); });

/// Returns the luminance times the solid angle of the whole picture.
double light_of(uint32_t width, uint32_t height, const std::vector<glm::vec3>& texels) {
    double sum = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            sum += luminance(glm::dvec3(texels[size_t{y} * width + x])) *
                   (std::cos(M_PI * y / height) - std::cos(M_PI * (y + 1.0) / height)) * 2 * M_PI / width;
    return sum;
}

TEST(GatherSky, PartsHaveAllOfTheLight) {
    Random random(5);
    for (const glm::uvec2 size :
         {glm::uvec2(1, 1), glm::uvec2(7, 3), glm::uvec2(500, 250), glm::uvec2(1024, 77)}) {
        auto sky = std::make_shared<Environment>();
        sky->width = size.x;
        sky->height = size.y;
        sky->texels.clear();
        for (uint32_t i = 0; i < size.x * size.y; ++i)
            sky->texels.push_back(glm::vec3(static_cast<float>(random.uniform())));
        if (size.y > 100) sky->texels[size.x * 40 + 3] = glm::vec3(1e6f);
        const GatherSky parts = gather_sky(sky);
        EXPECT_LE(parts.width, 256u);
        EXPECT_LE(parts.height, 128u);
        EXPECT_EQ(parts.bright != nullptr, size.y > 100);
        double sum = light_of(parts.width, parts.height, parts.texels);
        if (parts.bright) sum += light_of(size.x, size.y, parts.bright->texels);
        EXPECT_NEAR(sum / light_of(size.x, size.y, sky->texels), 1, 1e-4) << size.x;
    }
}

TEST(GatherSky, NoSkyAndABlackOneAreDark) {
    EXPECT_TRUE(gather_sky(nullptr).texels.empty());
    EXPECT_TRUE(gather_sky(scenes::even_sky(0)).texels.empty());
}

}  // namespace
}  // namespace lucarne::gi
