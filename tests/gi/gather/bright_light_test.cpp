// Light of small bright surfaces, which engines that gather find by rays of their own.
#include "gi/gather/bright_light.h"

#include <cmath>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::material;

class BrightLightInEngines : public OnDevice {
 protected:
    std::vector<glm::vec4> render(std::string_view engine, const scenes::AnalyticScene& scene) {
        const auto picture = scenes::render(*device, engine, scene);
        EXPECT_TRUE(picture) << picture.error().line();
        return picture ? picture->radiance : std::vector<glm::vec4>{};
    }
};

// A micro-buffer finds such a lamp with a sixth of a ray, so that without rays of its own most pixels of
// `micro` were black, and `environment` was off by .45 (standard deviation).
TEST_F(BrightLightInEngines, SmallBrightSurfacesLightThePictureSmoothly) {
    scenes::AnalyticScene scene;
    scene.materials = {material(1, 0, 1, 0), material(1, 0, 1, 1000)};
    scenes::add_rectangle(scene.surfels, glm::vec3(-1, -1, 0), 2.0f * kX, 2.0f * kY, 160, glm::vec3(0.5f));
    constexpr float kSide = 0.06f;
    scenes::add_rectangle(scene.surfels, glm::vec3(-kSide / 2, -kSide / 2, 3), kSide * kY, kSide * kX, 12,
                          glm::vec3(0.5f), 1);
    scene.camera = scenes::look(glm::vec3(0.3f, 0.2f, 1), glm::vec3(0.3f, 0.25f, 0), 0.4f, 48);
    scene.settings.set(kOnlyBounce, 1);
    scene.settings.set(kMicroBuffer, 24);
    scene.settings.set(kGatherEvery, 1);
    scene.settings.set(environment::kCacheSpacing, 4);
    scene.settings.set(reference::kSamples, 64);
    const std::vector<glm::vec4> truth = render("reference", scene);
    for (const std::string_view engine : {"micro", "environment"}) {
        const std::vector<glm::vec4> found = render(engine, scene);
        ASSERT_EQ(found.size(), truth.size());
        double squares = 0;
        for (size_t i = 0; i < truth.size(); ++i) {
            ASSERT_GT(truth[i].x, 0);
            const double error = found[i].x / truth[i].x - 1;
            squares += error * error;
        }
        EXPECT_NEAR(mean_luminance(found) / mean_luminance(truth), 0.986, 0.02) << engine;
        EXPECT_LT(std::sqrt(squares / static_cast<double>(truth.size())), 0.25) << engine;
    }
}

}  // namespace
}  // namespace lucarne::gi
