// Compares the presets of the vpl engine with each other on a noisy scan.
#include <random>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

/// A closed room of 3 m with a lamp. As in a scan, points lie a part of their radius beside the walls, and
/// their normals are off by some degrees.
scenes::AnalyticScene noisy_room() {
    scenes::AnalyticScene scene;
    scene.surfels = scenes::closed_box(3, 110, glm::vec3(.6f));
    std::mt19937 random(7);
    std::normal_distribution<float> noise;
    const auto off = [&](float size) {
        return size * glm::vec3(noise(random), noise(random), noise(random));
    };
    for (Surfel& s : scene.surfels) {
        s.position += s.normal * .2f * s.radius * noise(random);
        s.normal = glm::normalize(s.normal + off(.07f));
    }
    scene.lights = {scenes::spot(glm::vec3(1.4f, 1.6f, 2.6f), glm::vec3(1.2f, 1.8f, 0), 1.1f, .9f, 10)};
    scene.camera = scenes::look(glm::vec3(1.5f, .3f, 1.4f), glm::vec3(1.5f, 3, 1.2f), .9f, 48);
    return scene;
}

class VplPresetsTest : public OnDevice {
 protected:
    std::vector<glm::vec4> radiance(const scenes::AnalyticScene& scene, std::string_view engine) {
        auto rendered = scenes::render(*device, engine, scene);
        EXPECT_TRUE(rendered) << rendered.error().line();
        return rendered ? rendered->radiance : std::vector<glm::vec4>{};
    }
};

// Both presets see the same points here: with those that each of them would choose, the truths differ, too.
TEST_F(VplPresetsTest, highIsLessNoisyThanInteractive) {
    scenes::AnalyticScene scene = noisy_room();
    const auto with = [&](Effort effort, std::string_view engine, uint64_t seed = 1) {
        scene.settings = default_settings(effort);
        scene.settings.set(kOnlyBounce, 1);
        scene.settings.set(kSeed, seed);
        return radiance(scene, engine);
    };
    const auto half = with(Effort::high, "reference"), other = with(Effort::high, "reference", 2);
    const auto error = [&](Effort effort) {
        return compare_with_halves(with(effort, "vpl"), half, other, {});
    };
    const auto interactive = error(Effort::interactive), high = error(Effort::high);
    ASSERT_TRUE(interactive && high);
    EXPECT_LT(high->rel_mse, .8 * interactive->rel_mse);
}

}  // namespace
}  // namespace lucarne::gi::vpl
