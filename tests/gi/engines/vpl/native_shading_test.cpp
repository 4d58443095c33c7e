// The native passes of shading against the shaders, and for every instruction set.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "gi/engines/vpl/shading/shading.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/native/native.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/vpl/shading_scene.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

std::vector<VplLight> lights() {
    std::vector<VplLight> made;
    for (int i = 0; i < 64; ++i) {
        const float at = static_cast<float>(i % 32) / 32;
        VplLight light = kDeadLight;
        const bool floor = i % 2 == 0;
        light.position = floor ? glm::vec4(4 * at - 2, 0.5f + 2 * std::fmod(7 * at, 1.0f), -0.99f, 0.05f)
                               : glm::vec4(-1.99f, 0.5f + 2 * at, 2 * std::fmod(5 * at, 1.0f) - 1, 0.05f);
        light.normal = floor ? glm::vec4(0, 0, 1, 0.03f) : glm::vec4(1, 0, 0, 0.03f);
        light.diffuse = {1, 0.5f + at, 2 * at, 1};
        made.push_back(i == 13 ? kDeadLight : light);
    }
    return made;
}

struct Shaded {
    std::vector<glm::uvec2> joints;
    std::vector<uint32_t> isolated;
    std::vector<glm::vec4> light, own_light;
};

class NativeShading : public InBushRoom {
 protected:
    void SetUp() override {
        InBushRoom::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        camera_ = look({0.3f, -2, 0.4f}, {0, 3, 0}, 203, 151, 0.8f);
        camera_.right.w = 0.3f;
        ASSERT_TRUE(rasterize(*device, loaded_->cut, camera_, gbuffer_));
        seeds_.host_lights = lights();
        seeds_.lights = *device->buffer(seeds_.host_lights.size() * sizeof(VplLight), "lights");
        seeds_.lights.upload_all(seeds_.host_lights);
        PassTimes times(*device);
        ASSERT_TRUE(decode_casters(*device, loaded_->cut, maps_));
        const auto layout = atlas_layout(512, static_cast<uint32_t>(seeds_.host_lights.size()));
        ASSERT_TRUE(layout);
        ASSERT_TRUE(draw_shadow_maps(*device, loaded_->cut, seeds_, *layout, false, times, maps_));
    }

    Shaded shade(int64_t interleave) {
        const size_t pixels = size_t{camera_.width} * camera_.height;
        Buffer radiance = *device->buffer(pixels * sizeof(glm::vec4), "radiance");
        PassTimes times(*device);
        GlFrame on_device{*device, loaded_->pool, {&loaded_->cut, {}, &loaded_->cut}, gbuffer_, radiance};
        EngineSettings settings = test_settings();
        settings.set(kInterleave, interleave);
        Frame frame{.camera = camera_,
                    .materials = {scenes::material()},
                    .settings = settings,
                    .gl = on_device,
                    .times = times};
        EXPECT_TRUE(upload_materials(*device, frame.materials, materials_));
        Tiles tiles;
        EXPECT_TRUE(join_tiles(frame, false, tiles));
        EXPECT_TRUE(shade_tiles(frame, materials_, seeds_, maps_.layout, maps_.atlas, tiles));
        const uint32_t isolated = tiles.isolated.download_all<uint32_t>(4)[3];
        auto list = tiles.isolated.download_all<uint32_t>(4 + isolated);
        list.erase(list.begin(), list.begin() + 4);
        std::ranges::sort(list);
        return {tiles.joints.download_all<glm::uvec2>(pixels), std::move(list),
                tiles.diffuse.download_all<glm::vec4>(pixels),
                tiles.own_diffuse.download_all<glm::vec4>(pixels)};
    }

    CameraView camera_;
    GBuffer gbuffer_;
    Seeds seeds_;
    ShadowMaps maps_;
    Buffer materials_;
};

TEST_F(NativeShading, IsThatOfTheShaders) {
    for (const int64_t interleave : kInterleaves) {
        device->use_native_passes(true);
        const Shaded native = shade(interleave);
        device->use_native_passes(false);
        const Shaded shaders = shade(interleave);
        size_t joints = 0, shown = 0;
        for (size_t i = 0; i < native.joints.size(); ++i) {
            joints += native.joints[i] != shaders.joints[i] && shaders.light[i].x > 0;
            shown += shaders.light[i].x > 0;
        }
        EXPECT_GT(shown, native.joints.size() / 4) << interleave;
        EXPECT_LE(joints, shown / 1000) << interleave;
        if (interleave > 1) {
            EXPECT_GT(shaders.isolated.size(), 20u);
        }
        EXPECT_EQ(native.isolated, shaders.isolated) << interleave;
        // A receiver at the border of two texels of a map may read either.
        EXPECT_LE(different(native.light, shaders.light, 1e-3f, 1e-5f), shown / 200) << interleave;
        EXPECT_LE(different(native.own_light, shaders.own_light, 1e-3f, 1e-5f), shaders.isolated.size() / 20)
            << interleave;
    }
}

TEST_F(NativeShading, EveryInstructionSetGivesTheSameBits) {
    const Shaded fastest = shade(4);
    for (int set = 0; gi::native::use_instruction_set(set); ++set) {
        const Shaded again = shade(4);
        EXPECT_EQ(again.isolated, fastest.isolated) << set;
        EXPECT_EQ(again.joints, fastest.joints) << set;
        EXPECT_EQ(again.light, fastest.light) << set;
        EXPECT_EQ(again.own_light, fastest.own_light) << set;
    }
}

}  // namespace
}  // namespace lucarne::gi::vpl
