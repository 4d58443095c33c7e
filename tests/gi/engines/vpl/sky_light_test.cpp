// The direct light of the sky by coarse maps of many directions.
#include "gi/engines/vpl/sky/sky_light.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/vpl/options.h"
#include "gi/engines/vpl/sky/ordered.h"
#include "gi/host_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_options.h"
#include "gi/raster/native/native.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/vpl/shading_scene.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

using scenes::AnalyticScene;

class SkyLightTest : public OnDevice {
 protected:
    double mean(const char* engine, const AnalyticScene& scene, uint64_t frames) {
        double sum = 0;
        for (uint64_t i = 0; i < frames; ++i) {
            const auto one = scenes::render(*device, engine, scene, i);
            EXPECT_TRUE(one) << one.error().line();
            sum += mean_luminance(one->radiance) / static_cast<double>(frames);
        }
        return sum;
    }
};

/// A floor of 8 m seen from above, in the light of a sky alone.
AnalyticScene open_floor() {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, glm::vec3(-4, -4, 0), 8.0f * kX, 8.0f * kY, 160, glm::vec3(.5f));
    scene.camera = scenes::look(glm::vec3(.1f, -1, 2), glm::vec3(0, 0, 0), .4f, 48);
    scene.settings.set(kOnlyBounce, 0);
    return scene;
}

/// A room of 2 m with an opening of 1 m in the middle of its ceiling; its floor is seen from within.
AnalyticScene room_with_skylight() {
    AnalyticScene scene;
    for (const Surfel& s : scenes::closed_box(2, 100, glm::vec3(.5f)))
        if (s.position.z < 1.999f || std::max(std::abs(s.position.x - 1), std::abs(s.position.y - 1)) > .5f)
            scene.surfels.push_back(s);
    scene.environment = scenes::even_sky(10);
    scene.camera = scenes::look(glm::vec3(1, .9f, 1.5f), glm::vec3(1, 1, 0), .5f, 48);
    scene.settings.set(kOnlyBounce, 0);
    return scene;
}

/// The form factor from a point to the parallel rectangle [x0, x1] x [y0, y1] at a height of 2 m (Howell,
/// catalogue of radiation configuration factors, B-4: four rectangles with a corner above the point).
double form_factor(double x0, double x1, double y0, double y1) {
    const auto corner = [](double x, double y) {
        const double a = x / 2, b = y / 2, ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
        return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * std::numbers::pi);
    };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

TEST_F(SkyLightTest, OpenFloorReflectsTheRadianceOfAnEvenSkyTimesItsAlbedo) {
    AnalyticScene scene = open_floor();
    scene.environment = scenes::even_sky(2);
    for (const int64_t interleave : kInterleaves) {
        scene.settings.set(kInterleave, interleave);
        const auto lit = scenes::render(*device, "vpl", scene);
        ASSERT_TRUE(lit) << lit.error().line();
        for (const glm::vec4& pixel : lit->radiance) EXPECT_NEAR(pixel.x, 1, .05) << interleave;
        EXPECT_NEAR(mean_luminance(lit->radiance), 1, .01) << interleave;
    }
}

TEST_F(SkyLightTest, SkylightGivesTheFloorItsFormFactor) {
    const AnalyticScene scene = room_with_skylight();
    double truth = 0, found = 0;
    for (uint64_t frame = 0; frame < 4; ++frame) {
        const auto lit = scenes::render(*device, "vpl", scene, frame);
        ASSERT_TRUE(lit) << lit.error().line();
        for (size_t i = 0; i < lit->radiance.size(); ++i) {
            const glm::vec3 p = scenes::position_of(scene.camera, lit->texels, i);
            if (p.z > .01f) continue;
            found += lit->radiance[i].x;
            truth += .5 * 10 * form_factor(.5 - p.x, 1.5 - p.x, .5 - p.y, 1.5 - p.y);
        }
    }
    EXPECT_GT(truth, 0);
    // The rims of the discs around the opening cover 2 % of it.
    EXPECT_NEAR(found / truth, .98, .03);
}

TEST_F(SkyLightTest, WindowGivesTheLightOfTheReference) {
    AnalyticScene scene;
    for (const Surfel& s : scenes::closed_box(2, 50, glm::vec3(.5f)))
        if (s.position.x < 1.99f ||
            std::max(std::abs(s.position.y - 1.2f), std::abs(s.position.z - 1.3f)) > .25f)
            scene.surfels.push_back(s);
    scene.environment = scenes::even_sky(10);
    scene.settings.set(kOnlyBounce, 0);
    scene.camera = scenes::look({1.8f, 1, 1}, {.2f, .9f, .4f}, .8f, 48);
    scene.settings.set(reference::kSamples, 256);
    const double found = mean("vpl", scene, 4), truth = mean("reference", scene, 1);
    EXPECT_GT(truth, 0);
    EXPECT_NEAR(found / truth, 1, .04);
}

TEST_F(SkyLightTest, SealedRoomGetsNone) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(.9f));
    scene.environment = scenes::even_sky(1e4f);
    scene.settings.set(kOnlyBounce, 0);
    for (const int64_t interleave : kInterleaves)
        for (const glm::vec3& target : {glm::vec3(1.2f, 1.3f, .9f), glm::vec3(2, 2, 2), glm::vec3(0, 2, 0)}) {
            scene.settings.set(kInterleave, interleave);
            scene.camera = scenes::look(glm::vec3(.3f, .4f, .5f), target, 1, 64);
            const auto lit = scenes::render(*device, "vpl", scene);
            ASSERT_TRUE(lit) << lit.error().line();
            size_t bright = 0;
            for (const glm::vec4& pixel : lit->radiance) bright += pixel.x > 0;
            EXPECT_EQ(bright, 0u) << interleave << ", toward " << target.x;
        }
}

TEST_F(SkyLightTest, SmallBrightTexelIsLeftToSharpViewsAndLosesNoLight) {
    auto sky = std::make_shared<Environment>();
    sky->width = 64, sky->height = 32;
    sky->texels.assign(64 * 32, glm::vec3(1));
    constexpr uint32_t kRow = 6;
    sky->texels[kRow * 64 + 10] = glm::vec3(2000);
    SkyLight light;
    light.set_environment(sky);
    EXPECT_FALSE(light.dark());
    EXPECT_FALSE(light.bright().dark());
    AnalyticScene scene = open_floor();
    scene.environment = sky;
    const double step = std::numbers::pi / 32, top = kRow * step, low = top + step;
    // The integral of the cosine over the texel: width * (sin^2 low - sin^2 top) / 2.
    const double beam = 1999 * step * (std::pow(std::sin(low), 2) - std::pow(std::sin(top), 2)) / 2;
    EXPECT_NEAR(mean("vpl", scene, 2), .5 * (1 + beam / std::numbers::pi), .01 * beam);
    light.set_environment(scenes::even_sky(1));
    EXPECT_TRUE(light.bright().dark());
}

TEST_F(SkyLightTest, PictureWithoutSurfacesShowsTheSky) {
    AnalyticScene scene = open_floor();
    scene.environment = scenes::even_sky(2);
    scene.camera = scenes::look(glm::vec3(0, 0, 1), glm::vec3(0, 0, 5), .4f, 16);
    EXPECT_NEAR(mean("vpl", scene, 1), 2, 1e-5);
}

TEST(SkyMaps, ShowTheReceiversAndTheSceneBeforeThem) {
    const Bounds scene{glm::vec3(-10, -20, 0), glm::vec3(30, 20, 5)},
        receivers{glm::vec3(1, 2, 0), glm::vec3(9, 3, 2)};
    Light light{};
    for (const glm::vec3& way : {glm::vec3(.3f, .2f, -1), glm::vec3(1, 0, -.01f), glm::vec3(0, 0, -1)}) {
        light.direction = glm::vec4(glm::normalize(way), 0);
        const SkyMap map = sky_map(light, receivers, scene, 128, glm::vec2(.9f, .1f));
        EXPECT_LE(map.columns * map.rows, 128u * 128u);
        for (int corner = 0; corner < 8; ++corner) {
            const auto of = [&](const Bounds& box) {
                return glm::vec3(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                 corner & 4 ? box.max.z : box.min.z);
            };
            const glm::vec3 place = sky_place(map, of(receivers));
            EXPECT_GE(std::min(place.x, place.y), 1);
            EXPECT_LE(place.x, static_cast<float>(map.columns) - 1);
            EXPECT_LE(place.y, static_cast<float>(map.rows) - 1);
            EXPECT_GE(sky_place(map, of(scene)).z, -1e-3f);
        }
    }
}

TEST(SkyMaps, WordsOfFloatsKeepTheirOrder) {
    const float values[] = {-1e30f, -2, -1e-30f, 0, 1e-30f, .5f, 3, 1e30f};
    for (size_t i = 0; i < std::size(values); ++i) {
        EXPECT_EQ(ordered_value(ordered_code(values[i])), values[i]);
        if (i > 0) {
            EXPECT_LT(ordered_code(values[i - 1]), ordered_code(values[i]));
        }
    }
}

/// The passes in C++ against the shaders.
class NativeSkyLight : public InBushRoom {
 protected:
    void SetUp() override {
        InBushRoom::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        camera_ = look({0.3f, -2, 0.4f}, {0, 3, 0}, 203, 151, 0.8f);
        ASSERT_TRUE(rasterize(*device, loaded_->cut, camera_, gbuffer_));
        ASSERT_TRUE(decode_casters(*device, loaded_->cut, casters_));
    }

    struct Shaded {
        std::vector<glm::vec4> light, own_light;
    };
    Shaded shade(int64_t interleave) {
        const size_t pixels = size_t{camera_.width} * camera_.height;
        Buffer radiance = *device->buffer(pixels * sizeof(glm::vec4), "radiance");
        PassTimes times(*device);
        GlFrame on_device{*device, loaded_->pool, {&loaded_->cut, {}, &loaded_->cut}, gbuffer_, radiance};
        EngineSettings settings = test_settings();
        settings.set(kInterleave, interleave);
        settings.set(kSkyDirections, int64_t{64});
        Frame frame{.camera = camera_,
                    .materials = {scenes::material()},
                    .settings = settings,
                    .bounds = {glm::vec3(-2, 0, -2), glm::vec3(2, 4, 2)},
                    .gl = on_device,
                    .times = times};
        EXPECT_TRUE(upload_materials(*device, frame.materials, materials_));
        Tiles tiles;
        EXPECT_TRUE(join_tiles(frame, false, tiles));
        SkyLight sky;
        sky.set_environment(scenes::even_sky(1));
        EXPECT_TRUE(sky.add(frame, materials_, {}, casters_, tiles));
        return {tiles.diffuse.download_all<glm::vec4>(pixels),
                tiles.own_diffuse.download_all<glm::vec4>(pixels)};
    }

    CameraView camera_;
    GBuffer gbuffer_;
    ShadowMaps casters_;
    Buffer materials_;
};

TEST_F(NativeSkyLight, IsThatOfTheShaders) {
    for (const int64_t interleave : kInterleaves) {
        device->use_native_passes(true);
        const Shaded native = shade(interleave);
        device->use_native_passes(false);
        const Shaded shaders = shade(interleave);
        size_t lit = 0, isolated = 0;
        for (const glm::vec4& light : shaders.light) lit += light.x > 0;
        for (const glm::vec4& light : shaders.own_light) isolated += light.x > 0;
        EXPECT_GT(lit, shaders.light.size() / 4) << interleave;
        if (interleave > 1) {
            EXPECT_GT(isolated, 20u);
        }
        // A receiver at the border of two texels may read either, and a texel's middle lie on a rim.
        EXPECT_LE(different(native.light, shaders.light, 1e-3f, 1e-5f), lit / 50) << interleave;
        EXPECT_LE(different(native.own_light, shaders.own_light, 1e-3f, 1e-5f), isolated / 10) << interleave;
    }
}

TEST_F(NativeSkyLight, EveryInstructionSetGivesTheSameBits) {
    const Shaded fastest = shade(4);
    for (int set = 0; gi::native::use_instruction_set(set); ++set) {
        const Shaded again = shade(4);
        EXPECT_EQ(again.light, fastest.light) << set;
        EXPECT_EQ(again.own_light, fastest.own_light) << set;
    }
}

}  // namespace
}  // namespace lucarne::gi::vpl
