// The engine over frames: what an edit repeats gives the same picture, bit for bit, as everything anew.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

/// A box that a lamp lights, drawn by one engine from picture to picture.
class PathsEngine : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        auto made = make_engine("paths");
        ASSERT_TRUE(made) << made.error().line();
        engine_ = std::move(*made);
        options_.settings.set(kBounces, 3);
        options_.settings.set(paths::kPointSpacing, 6);  // bounds are those of a cube of 16 m
        options_.settings.set(paths::kGatherRays, 64);
        options_.settings.set(paths::kEntryPoints, 50'000);
        options_.materials = {scenes::material(), scenes::material(.5f)};
        options_.lights = {lamp(1.2f)};
        auto surfels = scenes::closed_box(2, 40, glm::vec3(.6f));
        for (size_t i = 0; i < surfels.size(); i += 3) surfels[i].material = 1;
        cloud_ = std::make_unique<SurfelCloud>(std::move(surfels));
        options_.bake = draw().bake;  // from now on
    }
    void TearDown() override {
        engine_.reset();
        OnDevice::TearDown();
    }
    static Light lamp(float x) { return scenes::spot({x, .9f, 1.7f}, {1, 1, 0}, .6f, .6f, 5); }
    /// Leaves the ceiling out, and lights the box by the sky instead of the lamp.
    void open_the_box() {
        auto surfels = scenes::closed_box(2, 40, glm::vec3(.6f));
        std::erase_if(surfels, [](const Surfel& s) { return s.normal.z < -.5f; });
        cloud_ = std::make_unique<SurfelCloud>(std::move(surfels));
        options_.bake = nullptr;
        options_.lights.clear();
        options_.environment = scenes::even_sky(1);
    }
    Lit draw() { return light_up(*device, *engine_, *cloud_, camera_, options_); }
    /// Draws with an engine that has drawn nothing before, and computes everything in advance anew.
    Lit draw_anew() {
        const auto fresh = make_engine("paths");
        LitOptions anew = options_;
        anew.bake = nullptr;
        return light_up(*device, **fresh, *cloud_, camera_, anew);
    }
    double stat(std::string_view name) const {
        const auto stats = engine_->stats();
        const auto found =
            std::ranges::find(stats, name, [](const auto& s) { return std::string_view(s.first); });
        return found == stats.end() ? -1 : found->second;
    }

    std::unique_ptr<Engine> engine_;
    std::unique_ptr<SurfelCloud> cloud_;
    CameraView camera_ = look({.3f, .4f, .5f}, {1.2f, 1.3f, .9f}, 48, 48);
    LitOptions options_;
};

TEST_F(PathsEngine, AMovedLampGivesThePictureOfAFreshPreparation) {
    const Lit first = draw();
    options_.lights = {lamp(.6f)};
    const Lit moved = draw();
    EXPECT_NE(moved.radiance, first.radiance);
    EXPECT_EQ(moved.radiance, draw_anew().radiance);
    options_.lights = {lamp(1.2f)};
    EXPECT_EQ(draw().radiance, first.radiance) << "and back";
}

TEST_F(PathsEngine, ManyLampsGiveThePictureOfAFreshPreparation) {
    for (int i = 0; i < 9; ++i) options_.lights.push_back(lamp(.4f + .1f * static_cast<float>(i)));
    draw();
    options_.lights[3] = lamp(.45f);
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
}

// A point light has six views and a rectangle four for each sample: each view sees its part of the scene.
TEST_F(PathsEngine, LampsOfAllKindsBounceAsMuchByRaysAsByMaps) {
    options_.settings.set(kOnlyBounce, 1);
    const Light lamps[] = {scenes::point({1.2f, .9f, 1.4f}, 1), lamp(1.2f),
                           scenes::rectangle_light({1, 1, 1.6f}, {.2f, 0, 0}, .2f, {0, 0, -1}, 5)};
    for (const Light& light : lamps) {
        options_.lights = {light};
        options_.settings.set(kShadows, Shadows::maps);
        const double by_maps = mean_luminance(draw().radiance);
        options_.settings.set(kShadows, Shadows::rays);
        const double by_rays = mean_luminance(draw().radiance);
        EXPECT_GT(by_maps, 0);
        EXPECT_NEAR(by_rays / by_maps, 1, 0.05) << "kind " << light.kind;
    }
}

TEST_F(PathsEngine, OtherShadowsGiveThePictureOfAFreshEngine) {
    auto surfels = scenes::closed_box(2, 40, glm::vec3(.6f));
    scenes::add_rectangle(surfels, {.8f, .6f, 1}, .5f * kX, .5f * kY, 10, glm::vec3(.6f));
    cloud_ = std::make_unique<SurfelCloud>(std::move(surfels));
    options_.bake = nullptr;
    options_.bake = draw().bake;
    const auto loaded = load_cloud(*device, *cloud_);
    ASSERT_TRUE(loaded) << loaded.error().line();
    const auto draw_by = [&](Engine& engine, Shadows shadows) {
        options_.settings.set(kShadows, shadows);
        const auto lit = draw_frame(*device, engine, (*loaded)->pool, (*loaded)->cut, camera_,
                                    {glm::vec3(0.0f), glm::vec3(2.0f)}, options_);
        EXPECT_TRUE(lit) << lit.error().line();
        return lit ? lit->radiance : std::vector<glm::vec4>{};
    };
    for (const Shadows shadows : {Shadows::rays, Shadows::maps, Shadows::rays})
        EXPECT_EQ(draw_by(*engine_, shadows), draw_by(**make_engine("paths"), shadows));
    EXPECT_NE(draw_by(*engine_, Shadows::maps), draw_by(*engine_, Shadows::rays));
}

TEST_F(PathsEngine, EditedMaterialsGiveThePictureOfAFreshPreparation) {
    const Lit first = draw();
    auto last = first.radiance;
    for (const Material& edited :
         {scenes::material(.9f, 0, 1, .2f), scenes::material(.5f, .4f, 20), scenes::material(.5f, .4f, 9)}) {
        options_.materials[1] = edited;
        const Lit lit = draw();
        EXPECT_NE(lit.radiance, last);
        EXPECT_EQ(lit.radiance, draw_anew().radiance);
        last = lit.radiance;
    }
}

TEST_F(PathsEngine, ALampMoreOrLessGivesThePictureOfAFreshPreparation) {
    draw();
    options_.lights.push_back(lamp(.5f));
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
    EXPECT_EQ(stat("lamps_computed"), 1) << "the other one has not moved";
    options_.lights.erase(options_.lights.begin());
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
    options_.lights.clear();
    for (const glm::vec4& pixel : draw().radiance) ASSERT_EQ(glm::vec3(pixel), kO);
}

TEST_F(PathsEngine, OtherBouncesAndTransportGiveThePictureOfAFreshPreparation) {
    for (const auto transport : {paths::Transport::photons, paths::Transport::links})
        for (const int32_t only : {2, -1}) {
            options_.settings.set(paths::kTransport, transport);
            options_.settings.set(kOnlyBounce, only);
            EXPECT_EQ(draw().radiance, draw_anew().radiance) << only;
        }
}

TEST_F(PathsEngine, AnotherCameraRepeatsNothingButPixels) {
    draw();
    camera_ = look({1.5f, .4f, .5f}, {.4f, 1.3f, .9f}, 48, 48);
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
}

TEST_F(PathsEngine, PixelsBetweenThoseThatGatherHaveTheirLight) {
    camera_ = look({.3f, .4f, .5f}, {1.2f, 1.3f, .9f}, 96, 72);
    options_.settings.set(kOnlyBounce, 1);
    options_.settings.set(kGatherEvery, 1);
    const Lit every = draw();
    for (const int64_t step : {2, 4}) {
        options_.settings.set(kGatherEvery, step);
        const Lit between = draw();
        EXPECT_NE(between.radiance, every.radiance);
        const ImageMetrics error = compare_images(between.radiance, every.radiance).value();
        EXPECT_LT(std::abs(error.luminance_error), 3e-3) << step;
        EXPECT_LT(error.rel_mse, 3e-3) << step;
        EXPECT_LT(stat("pixels_searched"), 96 * 72 / 2) << step;
        options_.lights = {lamp(.6f)};
        EXPECT_EQ(draw().radiance, draw_anew().radiance) << "with the points that were found before";
        options_.lights = {lamp(1.2f)};
    }
    options_.materials[1] = scenes::material(.5f, .4f, 20);
    const Lit glossy = draw();
    options_.settings.set(kGatherEvery, 1);
    EXPECT_EQ(draw().radiance, glossy.radiance) << "lobes need the points of each pixel";
}

TEST_F(PathsEngine, ColumnsOfAnotherPackingGiveThePictureOfAFreshPreparation) {
    // What the file keeps does not depend on colours: an edit reads it again with the new ones.
    draw();
    auto surfels = scenes::closed_box(2, 40, glm::vec3(.3f, .6f, .2f));
    cloud_ = std::make_unique<SurfelCloud>(std::move(surfels));
    auto loaded = load_cloud(*device, *cloud_);
    ASSERT_TRUE(loaded);
    const auto& how = *engine_->info().precomputes;
    BakeInput input;
    input.cut.surfels = (*loaded)->pool.download((*loaded)->cut);
    input.cut.bounds = {glm::vec3(cloud_->header().min), glm::vec3(cloud_->header().max)};
    input.settings = options_.settings;
    const auto kept = how.make();
    StepRunner<const BakeInput> runner;
    {
        BakeInput before = input;
        for (Surfel& s : before.cut.surfels) s.albedo = glm::vec3(.6f);
        runner.start(kept->steps(before));
        ASSERT_TRUE(runner.run(before, StepBudget{}));
    }
    const auto restored = how.make();
    ASSERT_TRUE(restored->restore(input, kept->save()));
    options_.bake = restored->snapshot();
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
}

// Coordinates of frames begin near the camera, and those of the bake stay. Rays of pixels, which are moved
// from their points', the points that they see and the sky are those of the same places.
TEST_F(PathsEngine, ThePictureIsTheSameWhereverTheCoordinatesOfTheFrameBegin) {
    const glm::vec3 offset(16, -8, 4);
    auto surfels = scenes::closed_box(2, 40, glm::vec3(.6f));
    for (size_t i = 0; i < surfels.size(); ++i) {
        surfels[i].material = i % 3 == 0 ? 1 : 0;
        surfels[i].position += offset;
    }
    const SurfelCloud elsewhere(std::move(surfels), {glm::dvec3(offset) - 8.0, 16});
    const CameraView from =
        look(offset + glm::vec3(.3f, .4f, .5f), offset + glm::vec3(1.2f, 1.3f, .9f), 48, 48);
    options_.settings.set(kOnlyBounce, 1);
    const auto drawn = [&](const SurfelCloud& cloud, const CameraView& camera) {
        return light_up(*device, **make_engine("paths"), cloud, camera, options_).radiance;
    };
    for (const bool moving : {false, true}) {
        options_.moving = moving;
        options_.lights = {lamp(1.2f)};
        options_.bake_offset = glm::vec3(0.0f);
        const auto here = drawn(*cloud_, camera_);
        options_.lights = {
            scenes::spot(offset + glm::vec3(1.2f, .9f, 1.7f), offset + glm::vec3(1, 1, 0), .6f, .6f, 5)};
        options_.bake_offset = offset;
        const auto error = compare_images(drawn(elsewhere, from), here);
        ASSERT_TRUE(error);
        EXPECT_LT(error->rel_mse, 1e-4) << moving;
        EXPECT_LT(std::abs(error->luminance_error), 1e-3) << moving;
    }
}

TEST_F(PathsEngine, WithoutABakeItShowsDirectLight) {
    options_.settings.set(kOnlyBounce, 0);
    const Lit direct = draw();
    options_.settings.set(kOnlyBounce, -1);
    const Lit whole = draw();
    EXPECT_GT(mean_luminance(whole.radiance), 1.1 * mean_luminance(direct.radiance));
    EXPECT_GT(stat("gathering_points"), 100);
    EXPECT_LT(stat("lonely_pixels"), 3) << "of 2304";
    class Nothing final : public Bake {};
    options_.bake = std::make_shared<Nothing>();
    EXPECT_EQ(draw().radiance, direct.radiance);
    EXPECT_EQ(stat("gathering_points"), 0);
}

TEST_F(PathsEngine, TheSkyLightsAnOpenBoxAsItsLinksSay) {
    // Without its ceiling the box is lit by the sky; both ways of the sky's light agree.
    open_the_box();
    options_.settings.set(kOnlyBounce, 1);
    options_.settings.set(*find_option("light_samples"), int64_t{128});
    const Lit by_links = draw();
    options_.bake = by_links.bake;
    options_.settings.set(paths::kSkyLight, paths::SkyLight::parallel);
    const Lit parallel = draw();
    EXPECT_NEAR(mean_luminance(by_links.radiance) / mean_luminance(parallel.radiance), 1, .03);
    options_.settings.set(paths::kSkyLight, paths::SkyLight::links);
    options_.index = 7;
    EXPECT_EQ(draw().radiance, by_links.radiance) << "it does not differ from frame to frame";
}

TEST_F(PathsEngine, PixelsSeeTheSkyByGatheringRaysAndWherePointsDisagreeByTheirOwn) {
    open_the_box();
    options_.settings.set(kOnlyBounce, 0);
    options_.settings.set(reference::kSamples, 512);
    const Lit lit = draw(), exact = light_up(*device, **make_engine("reference"), *cloud_, camera_, options_);
    const ImageMetrics error = compare_images(lit.radiance, exact.radiance).value();
    EXPECT_LT(std::abs(error.luminance_error), .02);
    EXPECT_LT(error.rel_mse, .025);
    options_.bake = lit.bake;
    options_.moving = true;
    const Lit in_motion = draw();
    options_.index = 7;
    EXPECT_EQ(draw().radiance, in_motion.radiance) << "it does not differ from frame to frame";
    options_.moving = false;
    options_.environment = scenes::even_sky(2);
    EXPECT_EQ(draw().radiance, draw_anew().radiance);
    const Lit diffuse = draw();
    options_.materials[0] = scenes::material(.5f, .4f, 20);
    const Lit glossy = draw();
    EXPECT_NE(glossy.radiance, diffuse.radiance);
    EXPECT_EQ(glossy.radiance, draw_anew().radiance) << "lobes reflect it as well";
    options_.settings.set(kOnlyBounce, -1);
    EXPECT_EQ(draw().radiance, draw_anew().radiance) << "with what is reflected further";
}

TEST_F(PathsEngine, NoSkyLeaksIntoASealedRoomWithDiscsThroughItsWalls) {
    // Floor and ceiling go on outside under the sky, so discs of both stick out through the walls. Before
    // what walls cut off was lit by itself, 4.7 % of the light outside were seen inside; the reference sees
    // none.
    std::vector<Surfel> surfels;
    const glm::vec3 x(1.96f, 0, 0), y(0, 1.96f, 0), z(0, 0, 1.96f), at(1.02f, 1.02f, 0);
    scenes::add_rectangle(surfels, kO, 4.0f * kX, 4.0f * kY, 80, glm::vec3(.6f));
    scenes::add_rectangle(surfels, glm::vec3(.6f, .6f, 1.96f), 2.8f * kY, 2.8f * kX, 56, glm::vec3(.6f));
    scenes::add_rectangle(surfels, at, y, z, 40, glm::vec3(.6f));
    scenes::add_rectangle(surfels, at + x, z, y, 40, glm::vec3(.6f));
    scenes::add_rectangle(surfels, at, z, x, 40, glm::vec3(.6f));
    scenes::add_rectangle(surfels, at + y, x, z, 40, glm::vec3(.6f));
    cloud_ = std::make_unique<SurfelCloud>(std::move(surfels));
    options_.bake = nullptr;
    // By links: light views would let light in beside the walls, where discs are nearer than their biases.
    options_.lights.clear();
    options_.environment = scenes::even_sky(100);
    options_.settings.set(kOnlyBounce, 1);
    camera_ = look({.4f, 2, 3}, {1.2f, 2, 0}, 48, 48);
    const double outside = mean_luminance(draw().radiance);
    camera_ = look({1.4f, 1.5f, .9f}, {2.2f, 2.3f, .4f}, 48, 48);
    const double inside = mean_luminance(draw().radiance);
    EXPECT_GT(outside, .5);
    EXPECT_LT(inside, 1e-12 * outside) << inside << " of " << outside;
    options_.settings.set(kOnlyBounce, 0);
    EXPECT_LT(mean_luminance(draw().radiance), 1e-12 * outside)
        << "4 % without the walls of points about them, .6 % with them";
}

}  // namespace
}  // namespace lucarne::gi
