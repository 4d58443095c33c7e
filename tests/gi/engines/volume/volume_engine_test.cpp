#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "gi/engines/volume/options.h"
#include "gi/engines/volume/volume.h"
#include "gi/gather/gather_options.h"
#include "gi/shared/brdf.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi {
namespace {

class VolumeEngineTest : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device_ = std::move(*made);
    }
    static void TearDownTestSuite() { device_.reset(); }

    static LitOptions options() {
        LitOptions options;
        options.lights = {scenes::spot({1, 1, 1.8f}, {1, 1, 0}, .6f, .6f, 5)};
        options.settings.set(volume::kVoxelCount, 32);
        options.settings.set(kBounces, 3);
        options.settings.set(kShadows, Shadows::maps);  // as in motion, which is compared with rest
        return options;
    }
    static CameraView camera() { return look({.3f, .4f, .5f}, {1.2f, 1.3f, .9f}, 32, 32); }

    static std::unique_ptr<Device> device_;
};
std::unique_ptr<Device> VolumeEngineTest::device_;

TEST_F(VolumeEngineTest, LightMadeInPartsIsThatMadeAtOnce) {
    const SurfelCloud room(scenes::closed_box(2, 60, glm::vec3(.6f)));
    const auto whole = light_up(*device_, *volume_engine().make(), room, camera(), options());
    const auto engine = volume_engine().make();
    LitOptions moving = options();
    moving.moving = true;
    moving.light_budget = StepBudget::timed(0);
    moving.lights[0].strength.x *= 2;
    // A first picture is whole: by day direct light alone would be black in a room.
    const auto first = light_up(*device_, *volume_engine().make(), room, camera(), moving);
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), moving).radiance, first.radiance);
    EXPECT_FALSE(engine->reads_light_cuts());
    moving.lights = options().lights;
    Lit lit = light_up(*device_, *engine, room, camera(), moving);
    EXPECT_NE(lit.radiance, whole.radiance);
    EXPECT_TRUE(engine->reads_light_cuts());
    int frames = 1;
    for (; engine->reads_light_cuts() && frames < 100; ++frames)
        lit = light_up(*device_, *engine, room, camera(), moving);
    EXPECT_GT(frames, 5);
    EXPECT_EQ(lit.radiance, whole.radiance);
}

TEST_F(VolumeEngineTest, LightOfAMomentAgoStaysWhileAScanGrows) {
    const SurfelCloud room(scenes::closed_box(2, 60, glm::vec3(.6f)));
    const auto engine = volume_engine().make();
    LitOptions grown = options();
    grown.settings.set(kOnlyBounce, 1);
    const Lit first = light_up(*device_, *engine, room, camera(), grown);
    grown.bounds = Bounds{glm::vec3(-1), glm::vec3(9)};
    grown.moving = true;
    grown.light_budget = StepBudget::timed(0);
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), grown).radiance, first.radiance);
    const auto anew = [&] { return light_up(*device_, *volume_engine().make(), room, camera(), grown); };
    grown.origin = {256, 0, 0};
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), grown).radiance, anew().radiance)
        << "its places are others, so it cannot be kept";
    grown.origin = {};
    grown.bounds = Bounds{glm::vec3(100), glm::vec3(109)};
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), grown).radiance, anew().radiance)
        << "it is that of another scan";
}

TEST_F(VolumeEngineTest, LightThatIsChangedAndChangedBackIsTheSame) {
    const SurfelCloud room(scenes::closed_box(2, 60, glm::vec3(.6f)));
    const auto engine = volume_engine().make();
    const auto first = light_up(*device_, *engine, room, camera(), options());
    LitOptions other = options();
    other.lights[0].strength.x *= 2;
    EXPECT_NE(light_up(*device_, *engine, room, camera(), other).radiance, first.radiance);
    other = options();
    other.materials = {scenes::material(.5f)};
    EXPECT_NE(light_up(*device_, *engine, room, camera(), other).radiance, first.radiance);
    other = options();
    other.settings.set(volume::kVoxelCount, 16);
    EXPECT_NE(light_up(*device_, *engine, room, camera(), other).radiance, first.radiance);
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), options()).radiance, first.radiance);
}

TEST_F(VolumeEngineTest, LightThatAStoppedFrameBeganIsNotKept) {
    const SurfelCloud room(scenes::closed_box(2, 60, glm::vec3(.6f)));
    const auto engine = volume_engine().make();
    const auto first = light_up(*device_, *engine, room, camera(), options());
    const std::atomic<bool> stop{true};
    LitOptions other = options();
    other.lights[0].strength.x *= 2;
    other.stop = &stop;
    light_up(*device_, *engine, room, camera(), other);
    EXPECT_FALSE(engine->reads_light_cuts());
    EXPECT_EQ(light_up(*device_, *engine, room, camera(), options()).radiance, first.radiance);
}

TEST_F(VolumeEngineTest, BouncesLitByAnEvenSkyAreThoseOfAnOpenFurnace) {
    // A pit without a lid: what the sky lights and what it reflects adds up to no more than the sky.
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, 2.0f * kX, 2.0f * kY, 80, glm::vec3(.5f));
    const SurfelCloud plate(surfels);
    LitOptions open = options();
    open.lights.clear();
    auto sky = std::make_shared<Environment>();
    sky->texels = {glm::vec3(1.0f)};
    open.environment = sky;
    const CameraView above = look({1, 1, 3}, {1, 1, 0}, 32, 32, .4f);
    open.settings.set(kOnlyBounce, 0);
    for (const glm::vec4& pixel : light_up(*device_, *volume_engine().make(), plate, above, open).radiance)
        EXPECT_NEAR(pixel.x, .5f, .01f) << "albedo times the sky";
    open.settings.set(kOnlyBounce, 1);
    for (const glm::vec4& pixel : light_up(*device_, *volume_engine().make(), plate, above, open).radiance)
        EXPECT_EQ(pixel.x, 0) << "a plate does not light itself";
    scenes::add_rectangle(surfels, kO, 2.0f * kY, 2.0f * kZ, 80, glm::vec3(.5f));  // a wall beside it
    const SurfelCloud corner(surfels);
    const Lit lit = light_up(*device_, *volume_engine().make(), corner, above, open);
    // The wall receives pi / 2 of the sky above the floor and as much below; what it reflects reaches the
    // floor by their form factor, .2 of the unit squares.
    double mean = 0;
    for (const glm::vec4& pixel : lit.radiance) mean += pixel.x / static_cast<double>(lit.radiance.size());
    EXPECT_GT(mean, .02);
    EXPECT_LT(mean, .5 * .5 * .5);
}

TEST_F(VolumeEngineTest, FinerLevelsFollowTheCameraInSteps) {
    const SurfelCloud room(scenes::closed_box(2, 60, glm::vec3(.6f)));
    LitOptions moving = options();
    moving.settings.set(volume::kVolumeLevels, 3);
    const auto engine = volume_engine().make();
    const Lit first = light_up(*device_, *engine, room, camera(), moving);
    for (const auto& [name, value] : first.stats)
        if (name == "finest_voxel_side") {
            EXPECT_NEAR(value, 2 / 29. / 4, 1e-3);
        }
    moving.moving = true;
    moving.light_budget = StepBudget::timed(0);
    const auto seen_from = [&](const glm::vec3& eye) {
        return light_up(*device_, *engine, room, look(eye, eye + glm::vec3(.9f, .9f, .4f), 32, 32), moving);
    };
    seen_from({.31f, .41f, .51f});
    EXPECT_FALSE(engine->reads_light_cuts()) << "a little step makes no light";
    Lit lit = seen_from({.8f, .9f, .5f});
    EXPECT_TRUE(engine->reads_light_cuts());
    int frames = 1;
    for (; engine->reads_light_cuts() && frames < 100; ++frames) lit = seen_from({.8f, .9f, .5f});
    EXPECT_GT(frames, 3);
    const auto other = volume_engine().make();
    moving.moving = false;
    EXPECT_EQ(
        lit.radiance,
        light_up(*device_, *other, room, look({.8f, .9f, .5f}, {1.7f, 1.8f, .9f}, 32, 32), moving).radiance)
        << "the light of a camera that has come there is that of one that was there";
}

TEST_F(VolumeEngineTest, TooManyVoxelsForHarmonicsAreAnError) {
    const SurfelCloud room(scenes::closed_box(2, 20, glm::vec3(.6f)));
    auto loaded = load_cloud(*device_, room);
    ASSERT_TRUE(loaded);
    LitOptions wide = options();
    wide.settings.set(volume::kVoxelCount, 128);
    wide.settings.set(volume::kTransport, volume::Transport::sh);
    const CameraView view = camera();
    GBuffer gbuffer;
    ASSERT_TRUE(rasterize(*device_, (*loaded)->cut, view, gbuffer));
    auto radiance = device_->buffer(size_t{view.width} * view.height * sizeof(glm::vec4), "radiance");
    ASSERT_TRUE(radiance);
    PassTimes times(*device_);
    const auto engine = volume_engine().make();
    GlFrame on_device{*device_, (*loaded)->pool, needed_cuts(engine->info(), (*loaded)->cut, 1), gbuffer,
                      *radiance};
    Frame frame{.camera = view,
                .lights = wide.lights,
                .settings = wide.settings,
                .bounds = {glm::vec3(0), glm::vec3(2)},
                .gl = on_device,
                .times = times};
    const auto drawn = engine->draw(frame);
    ASSERT_FALSE(drawn);
    EXPECT_NE(drawn.error().line().find("--voxels 64"), std::string::npos) << drawn.error().line();
    frame.settings.set(volume::kVoxelCount, 32);
    EXPECT_TRUE(engine->draw(frame)) << "the error is not kept";
}

TEST_F(VolumeEngineTest, SurfelsWithoutNormalsReflectLight) {
    // As in a scan that is still being read.
    auto surfels = scenes::closed_box(2, 60, glm::vec3(.6f));
    LitOptions bounce = options();
    bounce.settings.set(kOnlyBounce, 1);
    const auto mean = [&] {
        const Lit lit = light_up(*device_, *volume_engine().make(), SurfelCloud(surfels), camera(), bounce);
        double sum = 0;
        for (const glm::vec4& pixel : lit.radiance) sum += pixel.x;
        return sum / static_cast<double>(lit.radiance.size());
    };
    const double known = mean();
    for (Surfel& s : surfels) s.normal = glm::vec3(0.0f);
    EXPECT_NEAR(mean() / known, 1, .05);
}

TEST_F(VolumeEngineTest, VoxelsThatLoseStreetsAreSaidToBeWide) {
    const auto said = [&](float side) {
        const SurfelCloud room(scenes::closed_box(side, 40, glm::vec3(.6f)), {glm::dvec3(-1), side + 2});
        testing::internal::CaptureStderr();
        light_up(*device_, *volume_engine().make(), room, camera(), options());
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(said(40).find("voxels are wider"), std::string::npos);
    EXPECT_NE(said(200).find("voxels are wider than 2 m"), std::string::npos);
}

}  // namespace
}  // namespace lucarne::gi
