// Direct light in C++ against the shaders, for every instruction set, and both against formulas.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "gi/lighting/direct_light.h"
#include "gi/lighting/surfel_light.h"
#include "gi/raster/native/native.h"
#include "gi/scene/environment.h"
#include "gi/shared/brdf.h"
#include "gi/shared/environment.h"
#include "gi/shared/flat_surfel.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/lighting/town.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

/// A wall and a floor of two materials, and in front of them a small wall that casts shadows and a disc that
/// emits light.
std::vector<Surfel> yard(bool shadows) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-2, 3, -2}, 4.0f * kX, 4.0f * kZ, 100, {0.5f, 0.6f, 0.2f});
    scenes::add_rectangle(surfels, {-2, 0, -1}, 4.0f * kX, 3.0f * kY, 100, {0.7f, 0.5f, 0.9f}, 1);
    if (!shadows) return surfels;
    scenes::add_rectangle(surfels, {-0.5f, 2, -0.6f}, 0.8f * kX, 0.7f * kZ, 30, glm::vec3(0.4f));
    scenes::add_rectangle(surfels, {0.8f, 2, 0}, 0.4f * kX, 0.4f * kZ, 20, glm::vec3(0.4f), 2);
    return surfels;
}

Light make_light(uint32_t kind) {
    Light light = scenes::spot({-0.9f, 0.2f, 1.1f}, {0, 2.5f, -0.5f}, 0.7f, 0.7f * (1 - 0.4f), 20);
    light.kind = kind;
    if (kind == kDirectionalLight) light.direction.w = 0;
    if (kind == kRectangleLight) {
        light.extent = {0.2f, 0, 0, 0.3f};
        light.direction = {0, 0.8f, -0.6f, 0};
    }
    if (kind == kDiscLight) light.extent = {0, 0, 0, 0.2f};
    return light;
}

struct Shot {
    std::string name;
    CameraView camera;
    std::vector<Light> lights;
    bool sky = false;
    Bounds bounds{{-2, 0, -2}, {2, 3, 2}};
};

CameraView seen_by(uint32_t width, uint32_t height) {
    return look({0.3f, -2, 0.4f}, {0, 3, 0.8f}, width, height, 1.1f);
}

std::vector<Shot> table() {
    CameraView shifted = seen_by(203, 151), parallel = shifted;
    shifted.right.w = 0.3f;
    shifted.up.w = -0.2f;
    parallel.projection = kOrthographic;
    parallel.right *= 3.0f;
    parallel.up *= 3.0f;
    Light hard = make_light(kSpotLight);
    hard.direction.w = hard.position.w;
    return {{"spot", seen_by(203, 151), {make_light(kSpotLight)}},
            {"hard spot, shifted", shifted, {hard}},
            {"point", shifted, {make_light(kPointLight)}},
            {"directional, orthographic", parallel, {make_light(kDirectionalLight)}},
            {"rectangle", seen_by(96, 64), {make_light(kRectangleLight)}},
            {"sky", shifted, {}, true},
            {"sky, orthographic", parallel, {}, true},
            {"sky and lamps, narrow", seen_by(5, 83), {hard, make_light(kDiscLight)}, true},
            {"one pixel", seen_by(1, 1), {make_light(kPointLight)}, true}};
}

/// A picture of random texels, brighter above.
std::shared_ptr<const Environment> make_sky() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    Environment sky;
    sky.width = 37;
    sky.height = 18;
    sky.rotation = 0.7f;
    sky.texels.clear();
    for (uint32_t row = 0; row < sky.height; ++row)
        for (uint32_t column = 0; column < sky.width; ++column) {
            const float bright = row < 9 ? 2.0f : 0.1f;
            sky.texels.push_back(bright * glm::vec3(uniform(random), uniform(random), uniform(random)));
        }
    return std::make_shared<const Environment>(sky);
}

class NativeLight : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device->native_passes()) GTEST_SKIP() << "no native passes on this device";
        load(yard(true));
    }
    void TearDown() override {
        native::use_instruction_set(-1);
        OnDevice::TearDown();
    }
    void load(const std::vector<Surfel>& surfels) { load(SurfelCloud(surfels)); }
    void load(const SurfelCloud& cloud) {
        auto loaded = load_cloud(*device, cloud);
        ASSERT_TRUE(loaded);
        loaded_ = std::move(*loaded);
    }

    /// Draws the G-buffers of a picture and its light views, the same for native passes and shaders.
    void draw(const Shot& shot) {
        shot_ = shot;
        device->use_native_passes(true);
        pixels_ = size_t{shot.camera.width} * shot.camera.height;
        ASSERT_TRUE(rasterize(*device, loaded_->cut, shot.camera, gbuffer_));
        texels_ = gbuffer_.texels.download_all<GBufferTexel>(pixels_);
        ASSERT_TRUE(upload_materials(*device, materials_, device_materials_));
        radiance_ = *device->buffer(pixels_ * sizeof(glm::vec4), "radiance");
        with_frame([&](Frame& frame) {
            ASSERT_TRUE(upload_sky(frame, sky_));
            views_ = light_views(frame, sky_.directions, frame.index);
            shadows_.clear();
            for (const LightView& view : views_) {
                shadows_.emplace_back();
                ASSERT_TRUE(rasterize(*device, *view.cut, view.view, shadows_.back()));
            }
        });
    }
    /// The light of the picture; `twice` adds emission and background a second time.
    std::vector<glm::vec4> light(bool natively, bool twice = false) {
        radiance_.clear(0x7fc00000u);  // NaN: every pixel has to be written
        device->use_native_passes(natively);
        with_frame([&](Frame& frame) {
            EXPECT_TRUE(add_own_light(frame, device_materials_, sky_, false));
            for (size_t i = 0; i < views_.size(); ++i)
                EXPECT_TRUE(add_light(frame, device_materials_, views_[i], shadows_[i]));
            if (twice) {
                EXPECT_TRUE(add_own_light(frame, device_materials_, sky_, true));
            }
        });
        device->use_native_passes(true);
        return radiance_.download_all<glm::vec4>(pixels_);
    }
    /// The light of the sides of all surfels: front and back of each.
    struct SurfelSides {
        std::vector<glm::vec3> irradiance, directions;
    };
    SurfelSides surfel_light(bool natively, bool directed = true) {
        const std::vector<Surfel> surfels = loaded_->pool.download(loaded_->cut);
        const auto count = static_cast<uint32_t>(surfels.size());
        std::vector<FlatSurfel> flat;
        for (const Surfel& surfel : surfels) {
            // Every fifth lacks what light needs: a radius or a normal.
            const bool plain = flat.size() % 5 != 0;
            const bool small = flat.size() % 2 != 0;
            flat.push_back({surfel.position.x, surfel.position.y, surfel.position.z,
                            plain || small ? surfel.radius : 0, surfel.area, encode_octahedral(surfel.normal),
                            plain || !small ? kSurfelHasNormal : 0, surfel.material, 0});
        }
        Buffer held = *device->buffer(count * sizeof(FlatSurfel), "surfels");
        held.upload_all(flat);
        Buffer irradiance = *device->buffer(2 * count * sizeof(glm::vec3), "light");
        Buffer directions = *device->buffer(2 * count * sizeof(glm::vec3), "directions");
        irradiance.clear(0);
        directions.clear(0);
        device->use_native_passes(natively);
        for (size_t i = 0; i < views_.size(); ++i)
            EXPECT_TRUE(add_surfel_light(*device, held, count, views_[i], shadows_[i], irradiance,
                                         directed ? &directions : nullptr));
        device->use_native_passes(true);
        return {irradiance.download_all<glm::vec3>(2 * count), directions.download_all<glm::vec3>(2 * count)};
    }
    template <class Body>
    void with_frame(const Body& body) {
        PassTimes times(*device);
        const FrameCuts cuts{&loaded_->cut, std::vector<const DeviceCut*>(shot_.lights.size(), &loaded_->cut),
                             &loaded_->cut};
        GlFrame on_device{*device, loaded_->pool, cuts, gbuffer_, radiance_};
        const EngineSettings settings = test_settings();
        Frame frame{.camera = shot_.camera,
                    .lights = shot_.lights,
                    .materials = materials_,
                    .background = {0.3f, 0.2f, 0.1f},
                    .settings = settings,
                    .environment = shot_.sky ? environment_ : nullptr,
                    .bounds = shot_.bounds,
                    .gl = on_device,
                    .times = times};
        body(frame);
    }
    bool shown(size_t pixel) const { return texels_[pixel].depth > 0; }
    glm::vec3 ray(size_t pixel) const {
        const CameraView& view = shot_.camera;
        const glm::vec2 at(static_cast<float>(pixel % view.width) + 0.5f,
                           static_cast<float>(pixel / view.width) + 0.5f);
        return view_ray(view, at);
    }

    std::unique_ptr<LoadedCloud> loaded_;
    std::vector<Material> materials_ = {scenes::material(), scenes::material(1.3f),
                                        scenes::material(1, 0, 1, 2)};
    std::shared_ptr<const Environment> environment_ = make_sky();
    Shot shot_;
    GBuffer gbuffer_;
    Sky sky_;
    Buffer device_materials_, radiance_;
    std::vector<LightView> views_;
    std::vector<GBuffer> shadows_;
    size_t pixels_ = 0;
    std::vector<GBufferTexel> texels_;
};

bool alike(const glm::vec4& a, const glm::vec4& b, float share = 1e-4f) {
    return glm::distance(a, b) <= share * glm::length(a);
}

TEST_F(NativeLight, IsThatOfTheShadersInNestedViews) {
    load(scenes::town());
    draw({"town",
          scenes::seen_town(150),
          {scenes::wide_sun({.3f, .5f, -.6f}, 0, 5)},
          false,
          scenes::town_bounds()});
    ASSERT_GT(views_.size(), 1u);
    for (const LightView& seen : views_) {  // each shows what it has to, also where the scan ends
        if (seen.face + 1 == seen.light.nested) continue;
        const glm::vec3 along(seen.light.direction),
            across = glm::normalize(glm::cross(along, glm::vec3(0, 0, 1)));
        const float half = seen.light.position.w * std::pow(kNestedStep, static_cast<float>(seen.face));
        for (const float toward : {-13.0f, 0.0f, 13.0f})
            for (const float side : {-.999f, .999f}) {
                float depth = 0;
                const glm::vec2 at = view_place(
                    seen.view, glm::vec3(seen.light.position) + toward * along + side * half * across, depth);
                EXPECT_GT(at.x, 0) << toward;
                EXPECT_LT(at.x, static_cast<float>(seen.view.width)) << toward;
                EXPECT_GT(depth, 0) << toward;
            }
    }
    const auto natively = light(true), by_shaders = light(false);
    size_t others = 0;
    for (size_t i = 0; i < pixels_; ++i) others += !alike(natively[i], by_shaders[i]);
    EXPECT_LE(others, pixels_ / 100) << "points at the borders of shadows";
    const auto lit = surfel_light(true).irradiance, lit_by_shaders = surfel_light(false).irradiance;
    others = 0;
    for (size_t i = 0; i < lit.size(); ++i)
        others += !alike(glm::vec4(lit[i], 0), glm::vec4(lit_by_shaders[i], 0));
    EXPECT_LE(others, lit.size() / 100);
}

TEST_F(NativeLight, IsThatOfTheShaders) {
    for (const Shot& shot : table()) {
        draw(shot);
        for (const bool twice : {false, true}) {
            const auto natively = light(true, twice), by_shaders = light(false, twice);
            size_t others = 0, lit = 0, dark = 0;
            for (size_t i = 0; i < pixels_; ++i) {
                others += !alike(natively[i], by_shaders[i]);
                if (shown(i)) ++(by_shaders[i].x > 0 ? lit : dark);
            }
            // Points at the borders of shadows and faces, rays at the borders of texels of the sky.
            EXPECT_LE(others, pixels_ / 250) << shot.name << twice;
            if (pixels_ < 5000) continue;
            EXPECT_GT(lit, pixels_ / 8) << shot.name;
            if (!shot.sky) {
                EXPECT_GT(dark, pixels_ / 100) << shot.name;
            }
        }
    }
}

TEST_F(NativeLight, OfSurfelsIsThatOfTheShaders) {
    for (const Shot& shot : table()) {
        if (shot.camera.width == 1) continue;
        draw(shot);
        const SurfelSides natively = surfel_light(true), by_shaders = surfel_light(false);
        ASSERT_EQ(natively.irradiance.size(), by_shaders.irradiance.size());
        const size_t sides = natively.irradiance.size();
        size_t others = 0, lit = 0, turned = 0;
        for (size_t i = 0; i < sides; ++i) {
            const auto same = [](const glm::vec3& a, const glm::vec3& b) {
                return glm::distance(a, b) <= 1e-4f * glm::length(b) + 1e-7f;
            };
            others += !same(natively.irradiance[i], by_shaders.irradiance[i]) ||
                      !same(natively.directions[i], by_shaders.directions[i]);
            lit += by_shaders.irradiance[i].x > 0;
            turned += i % 2 == 1 && by_shaders.irradiance[i].x > 0;
        }
        EXPECT_LE(others, sides / 200) << shot.name;
        EXPECT_GT(lit, sides / 20) << shot.name;
        EXPECT_LT(lit, sides) << shot.name;
        EXPECT_TRUE(turned > 0 || !shot.sky) << shot.name << ": the backs of the floor see the sky below";
        EXPECT_EQ(surfel_light(true, false).irradiance, natively.irradiance) << "without directions";
        for (int set = 0; native::use_instruction_set(set); ++set)
            EXPECT_EQ(surfel_light(true).irradiance, natively.irradiance) << shot.name << ", set " << set;
        native::use_instruction_set(-1);
    }
}

TEST_F(NativeLight, EveryInstructionSetAndNumberOfThreadsGivesTheSameBits) {
    for (const Shot& shot : table()) {
        draw(shot);
        native::use_instruction_set(-1);
        const auto fastest = light(true);
        {
            const ThreadLimit one(1);
            EXPECT_EQ(light(true), fastest) << shot.name << ", one thread";
        }
        int sets = 0;
        for (; native::use_instruction_set(sets); ++sets)
            EXPECT_EQ(light(true), fastest) << shot.name << ", set " << sets;
        EXPECT_GE(sets, 1);
    }
}

TEST_F(NativeLight, AWallReflectsWhatTheLightSends) {
    load(yard(false));
    for (const Shot& shot : table()) {
        if (shot.sky || shot.lights.front().kind == kRectangleLight) continue;
        draw(shot);
        for (const bool natively : {false, true}) {
            const auto lit = light(natively);
            size_t others = 0, faced = 0;
            for (size_t i = 0; i < pixels_; ++i) {
                if (!shown(i)) continue;
                const glm::vec2 pixel(i % shot.camera.width, i / shot.camera.width);
                const glm::vec3 position = texel_position(shot.camera, pixel, texels_[i]);
                glm::vec3 to_light;
                const glm::vec3 irradiance = light_irradiance(shot.lights[0], position,
                                                              decode_octahedral(texels_[i].normal), to_light);
                const glm::vec3 kd = make_reflectance(materials_[texels_[i].material & 0xffffu],
                                                      decode_albedo(texels_[i].albedo))
                                         .kd;
                faced += irradiance.x > 0;
                others += !alike(lit[i], glm::vec4(irradiance * kd / kPi, 1));
            }
            EXPECT_GT(faced, pixels_ / 8) << shot.name;
            // The rims of both rectangles.
            EXPECT_LE(others, faced / 20) << shot.name << natively;
        }
    }
}

TEST_F(NativeLight, EmptyPixelsShowTheSky) {
    for (const Shot& shot : table()) {
        draw(shot);
        for (const bool natively : {false, true}) {
            const auto seen = light(natively);
            size_t others = 0, empty = 0;
            for (size_t i = 0; i < pixels_; ++i) {
                if (shown(i)) continue;
                const bool parallel = shot.camera.projection == kOrthographic;
                const glm::vec3 direction =
                    glm::normalize(parallel ? glm::vec3(shot.camera.forward) : ray(i));
                const glm::vec3 expected =
                    shot.sky ? environment_->radiance(direction) : glm::vec3(0.3f, 0.2f, 0.1f);
                others += seen[i] != glm::vec4(expected, 1);
                ++empty;
            }
            EXPECT_LE(others, empty / 500) << shot.name << natively;
            if (pixels_ > 5000) {
                EXPECT_GT(empty, pixels_ / 50) << shot.name;
            }
        }
    }
}

TEST_F(NativeLight, LobesAreLeftToTheShader) {
    materials_[1] = scenes::material(0.5f, 0.4f, 20);
    draw(table().front());
    EXPECT_EQ(light(true), light(false));
    materials_[1] = scenes::material(0.5f, 0, 20);
    draw(table().front());
    EXPECT_NE(light(true), light(false));
}

/// Depths that are no numbers, in the picture and in the shadow map.
TEST_F(NativeLight, HandlesNaNAsTheShadersDo) {
    for (const Shot& shot : table()) {
        if (shot.camera.width == 1) continue;
        draw(shot);
        constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
        for (size_t i = 0; i < pixels_; i += 37) texels_[i].depth = kNaN;
        gbuffer_.texels.upload_all(texels_);
        for (GBuffer& shadow : shadows_) {
            auto held = shadow.texels.download_all<GBufferTexel>(size_t{shadow.width} * shadow.height);
            for (size_t i = 0; i < held.size(); i += 41) held[i].depth = kNaN;
            shadow.texels.upload_all(held);
        }
        const auto natively = light(true), by_shaders = light(false);
        size_t others = 0;
        // Beside such a texel, the weights of the others round differently: views of the sky are far away.
        for (size_t i = 0; i < pixels_; ++i) others += !alike(natively[i], by_shaders[i], 1e-2f);
        EXPECT_LE(others, pixels_ / 250) << shot.name;
        for (int set = 0; native::use_instruction_set(set); ++set)
            EXPECT_EQ(light(true), natively) << shot.name << ", set " << set;
        native::use_instruction_set(-1);
    }
}

}  // namespace
}  // namespace lucarne::gi
