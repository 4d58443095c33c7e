// Glossy surfaces reflect the light that caches hold by direction.
#include "gi/engines/environment/glossy_caches.h"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/kept_caches.h"
#include "gi/engines/environment/options.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "gi/lighting/lobe_albedo.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/glossy_corner.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;

class GlossyCaches : public OnDevice {
 protected:
    Lit render(const AnalyticScene& scene, std::string_view engine = "environment") {
        auto lit = scenes::render(*device, engine, scene);
        EXPECT_TRUE(lit) << lit.error().line();
        return lit ? *std::move(lit) : Lit{};
    }
};

TEST_F(GlossyCaches, EvenSkyIsReflectedByTheLobesAlbedo) {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, glm::vec3(0.0f), glm::vec3(2, 0, 0), glm::vec3(0, 2, 0), 60,
                          glm::vec3(.5f));
    scene.materials = {scenes::material(.5f, .4f, 12, 0)};
    auto sky = std::make_shared<Environment>();
    sky->width = 4;
    sky->height = 2;
    sky->texels.assign(8, glm::vec3(3.0f));
    scene.environment = sky;
    scene.camera = scenes::look(glm::vec3(1, -1.2f, 1.1f), glm::vec3(1, 1, 0), .15f, 32);
    scene.settings.set(kOnlyBounce, 0);
    const Lit lit = render(scene);
    const LobeAlbedo albedo(12);
    for (size_t pixel = 0; pixel < lit.radiance.size(); ++pixel) {
        if (!(lit.texels[pixel].depth > 0)) continue;
        const glm::vec3 to =
            glm::normalize(glm::vec3(1, -1.2f, 1.1f) - scenes::position_of(scene.camera, lit.texels, pixel));
        EXPECT_NEAR(lit.radiance[pixel].y, 3 * (.25f + .4f * albedo.at(to.z)), .01f);
    }
}

TEST_F(GlossyCaches, SurfacesReflectTheLightOfALampAsInTheReference) {
    for (const bool all : {false, true})
        for (const float exponent : {4.0f, 12.0f, 28.0f}) {
            AnalyticScene scene = scenes::glossy_corner(exponent);
            if (!all) {
                scene.materials.insert(scene.materials.begin(), scenes::material(1, 0, 1, 0));
                for (Surfel& s : scene.surfels)
                    if (s.normal.z > .9f) s.material = 1;  // the floor alone
            }
            scene.settings.set(environment::kCacheSpacing, 3);
            scene.settings.set(reference::kSamples, 128);
            const auto mean = [&](std::string_view engine) {
                return mean_luminance(render(scene, engine).radiance);
            };
            const double truth = mean("reference"), cached = mean("environment");
            scene.settings.set(environment::kGlossyCaches, false);
            const double gathered = mean("environment");
            EXPECT_NE(cached, gathered);
            EXPECT_NEAR(cached / truth, 1, all ? .05 : .03) << exponent;
            EXPECT_NEAR(cached / gathered, 1, all ? .05 : .01) << exponent;
        }
}

TEST_F(GlossyCaches, NarrowLobesGatherByThemselves) {
    AnalyticScene scene = scenes::glossy_corner(100);
    const auto cached = render(scene).radiance;
    scene.settings.set(environment::kGlossyCaches, false);
    EXPECT_EQ(render(scene).radiance, cached);
}

TEST(KeptCaches, KeepLightByDirectionOfTheLastAlone) {
    environment::KeptCaches kept;
    environment::Cache cache{
        glm::vec3(0, 0, 5), glm::vec3(0, 0, -1), 1, {}, std::make_shared<LightByDirection>()};
    const std::vector<environment::Cache> many(environment::kMostGlossyCaches - 10, cache);
    kept.take(scenes::look(glm::vec3(0.0f), glm::vec3(0, 1, 0), .5f, 8), test_settings(), 1, many);
    kept.add(std::vector<environment::Cache>(30, cache));
    ASSERT_EQ(kept.all().size(), many.size() + 30);
    EXPECT_FALSE(kept.all()[19].by_direction);
    EXPECT_TRUE(kept.all()[20].by_direction);
    EXPECT_TRUE(kept.all().back().by_direction);
}

}  // namespace
}  // namespace lucarne::gi
