// Pictures of surfels made by hand, as the G-buffer holds them.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "gi/raster/blend.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {

inline const glm::vec3 kWhite(0.8f), kRed(0.8f, 0.0f, 0.0f);

struct Picture {
    CameraView view;
    std::vector<GBufferTexel> texels;
    std::vector<uint32_t> ids;
    std::vector<Surfel> surfels;  ///< as the device stores them

    glm::vec3 ray(uint32_t x, uint32_t y) const { return view_ray(view, glm::vec2(x, y) + 0.5f); }
    glm::vec3 eye() const { return {view.origin.x, view.origin.y, view.origin.z}; }
    bool empty(size_t at) const { return ids[at] == kNoSurfel; }
    bool red(size_t at) const { return !empty(at) && decode_albedo(texels[at].albedo).y < 0.1f; }
};

inline std::string passes_name(const ::testing::TestParamInfo<bool>& native) {
    return native.param ? "native" : "shaders";
}

/// Draws surfels made by hand, by shaders or by native passes.
class GBufferTest : public OnDevice, public ::testing::WithParamInterface<bool> {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (GetParam() && !device->native_passes()) GTEST_SKIP() << "no native passes on this device";
        device->use_native_passes(GetParam());
    }
    Picture draw(std::vector<Surfel> surfels, const CameraView& view, uint32_t keep = 1024,
                 bool blended = false, const PointSize& size = {}) {
        const SurfelCloud cloud(std::move(surfels), {{-32, -32, -32}, 64}, keep);
        auto loaded = load_cloud(*device, cloud);
        EXPECT_TRUE(loaded) << loaded.error().line();
        GBuffer target;
        const auto drawn = rasterize(*device, (*loaded)->cut, view, target, size);
        EXPECT_TRUE(drawn) << drawn.error().line();
        if (blended) {
            const auto mixed = blend(*device, (*loaded)->cut, view, target, size);
            EXPECT_TRUE(mixed) << mixed.error().line();
        }
        const size_t pixels = size_t{view.width} * view.height;
        return {view, target.texels.download_all<GBufferTexel>(pixels),
                target.ids.download_all<uint32_t>(pixels), (*loaded)->pool.download((*loaded)->cut)};
    }
};

/// A wall at y = `at`, facing the camera, as an uneven pattern of about `spacing` metres.
inline std::vector<Surfel> wall(float at, float half, float spacing, const glm::vec3& albedo, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> jitter(-0.5f, 0.5f);
    std::vector<Surfel> surfels;
    for (float x = -half; x <= half; x += spacing)
        for (float z = -half; z <= half; z += spacing)
            surfels.push_back({{x + jitter(random) * spacing, at, z + jitter(random) * spacing},
                               glm::normalize(glm::vec3(0.1f * jitter(random), -1, 0.1f * jitter(random))),
                               albedo,
                               0,
                               spacing * spacing,
                               0});
    return surfels;
}

inline void append(std::vector<Surfel>& to, const std::vector<Surfel>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

}  // namespace lucarne::gi
