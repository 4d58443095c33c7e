// Merging in C++ against the shader, for every instruction set, and both against means computed by hand.
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/shading/shading.h"
#include "gi/lighting/direct_light.h"
#include "gi/raster/native/native.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/vpl/shading_scene.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Shot {
    std::string name;
    CameraView camera;
    int64_t interleave;
};

CameraView shifted(CameraView camera, float right, float down) {
    camera.right.w = right;
    camera.up.w = down;
    return camera;
}

CameraView orthographic(CameraView camera) {
    camera.projection = kOrthographic;
    camera.right *= 3.0f;
    camera.up *= 3.0f;
    return camera;
}

CameraView seen_by(uint32_t width, uint32_t height) {
    return look({0.3f, -2, 0.4f}, {0, 3, 0}, width, height, 0.8f);
}

std::vector<Shot> table() {
    const CameraView camera = seen_by(203, 151);
    return {{"one tile", camera, 1},
            {"2 x 2 tiles", shifted(camera, 0.3f, -0.2f), 2},
            {"4 x 4 tiles", shifted(camera, -0.4f, 0.1f), 4},
            {"orthographic", orthographic(camera), 4},
            {"whole vectors", seen_by(64, 80), 4},
            {"narrower than a vector", seen_by(5, 97), 4},
            {"narrower than a window", seen_by(3, 2), 4},
            {"one pixel", seen_by(1, 1), 4},
            {"one pixel, 2 x 2 tiles", seen_by(1, 1), 2}};
}

/// The light of the tiles of a frame, W/m^2, one a pixel; `own` is that of isolated pixels.
struct TileLight {
    std::vector<glm::vec4> diffuse, own;
};

/// What the merged frames of a motion look like.
struct Merged {
    std::vector<glm::vec4> alone;                ///< the last frame without history
    std::vector<std::vector<glm::vec4>> frames;  ///< with history
};

/// Equal bits, but for those of numbers that are none.
bool same(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    return std::ranges::equal(a, b, [](const glm::vec4& v, const glm::vec4& w) {
        for (int i = 0; i < 4; ++i)
            if (!(v[i] == w[i] || (std::isnan(v[i]) && std::isnan(w[i])))) return false;
        return true;
    });
}

/// Returns how many pixels differ by more than rounding; pixels without numbers count as 0.
size_t unlike(std::vector<glm::vec4> a, std::vector<glm::vec4> b) {
    for (auto* picture : {&a, &b})
        for (glm::vec4& pixel : *picture)
            if (std::isnan(pixel.x + pixel.y + pixel.z)) pixel = glm::vec4(0);
    return different(a, b, 1e-5f, 0);
}

class NativeMerge : public InBushRoom {
 protected:
    void SetUp() override {
        InBushRoom::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        materials_ = {scenes::material(), scenes::material(1.4f)};
        ASSERT_TRUE(upload_materials(*device, materials_, device_materials_));
    }

    /// Draws and joins a picture, the same for native passes and shaders.
    void draw(const Shot& shot) {
        shot_ = shot;
        device->use_native_passes(true);
        ASSERT_TRUE(rasterize(*device, loaded_->cut, shot.camera, gbuffer_));
        with_frame([&](Frame& frame) { ASSERT_TRUE(join_tiles(frame, false, tiles_)); });
        pixels_ = size_t{shot.camera.width} * shot.camera.height;
        texels_ = gbuffer_.texels.download_all<GBufferTexel>(pixels_);
        const uint32_t isolated = tiles_.isolated.download_all<uint32_t>(4)[3];
        const auto list = tiles_.isolated.download_all<uint32_t>(4 + isolated);
        isolated_.assign(list.begin() + 4, list.end());
    }
    /// Random light in the tiles of the picture.
    TileLight random_light(unsigned seed) const {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> uniform(0, 2);
        TileLight light = even_light(0);
        for (glm::vec4& pixel : light.diffuse) pixel = {uniform(random), uniform(random), uniform(random), 0};
        for (const uint32_t pixel : isolated_) light.own[pixel] = {uniform(random), 1, uniform(random), 0};
        return light;
    }
    /// The same light in all tiles. Isolated pixels have that of the tiles that they lack.
    TileLight even_light(float irradiance) const {
        TileLight light{std::vector<glm::vec4>(pixels_, glm::vec4(glm::vec3(irradiance), 0)),
                        std::vector<glm::vec4>(pixels_, glm::vec4(0))};
        const auto joints = tiles_.joints.download_all<glm::uvec2>(pixels_);
        for (const uint32_t pixel : isolated_) {
            int64_t lacking = 0;
            for (int i = 0; i < shot_.interleave * shot_.interleave; ++i)
                lacking += ((i < 8 ? joints[pixel].x : joints[pixel].y) >> 4 * (i & 7) & 15) == 0;
            light.own[pixel] = glm::vec4(glm::vec3(irradiance * static_cast<float>(lacking)), 0);
        }
        return light;
    }
    std::vector<glm::vec4> merge(const TileLight& light, bool natively, History* history) {
        tiles_.diffuse.upload_all(light.diffuse);
        tiles_.own_diffuse.upload_all(light.own);
        radiance_ = *device->buffer(pixels_ * sizeof(glm::vec4), "radiance");
        radiance_.clear(0x7fc00000u);  // NaN: every pixel has to be written
        device->use_native_passes(natively);
        with_frame([&](Frame& frame) {
            if (history) {
                EXPECT_TRUE(history->begin(frame, {}));
            }
            EXPECT_TRUE(merge_tiles(frame, device_materials_, tiles_, history));
        });
        device->use_native_passes(true);
        return radiance_.download_all<glm::vec4>(pixels_);
    }
    /// Merges the frames of a camera that moves to the right; the last one is shot_.
    Merged move(const Shot& shot, bool natively) {
        Merged merged;
        History history;
        for (const int left : {3, 2, 1, 0}) {
            Shot moved = shot;
            moved.camera.origin.x -= 0.013f * static_cast<float>(left);
            draw(moved);
            merged.frames.push_back(merge(random_light(static_cast<unsigned>(left)), natively, &history));
        }
        merged.alone = merge(random_light(0), natively, nullptr);
        return merged;
    }
    template <class Body>
    void with_frame(const Body& body) {
        PassTimes times(*device);
        GlFrame on_device{*device, loaded_->pool, {&loaded_->cut, {}, &loaded_->cut}, gbuffer_, radiance_};
        EngineSettings settings = test_settings();
        settings.set(kInterleave, shot_.interleave);
        Frame frame{.camera = shot_.camera,
                    .materials = materials_,
                    .settings = settings,
                    .gl = on_device,
                    .times = times};
        body(frame);
    }
    glm::vec3 reflectance(size_t pixel) const {
        const GBufferTexel& texel = texels_[pixel];
        return make_reflectance(materials_[texel.material & 0xffffu], decode_albedo(texel.albedo)).kd;
    }
    size_t shown() const {
        return static_cast<size_t>(
            std::ranges::count_if(texels_, [](const GBufferTexel& texel) { return texel.depth > 0; }));
    }

    std::vector<Material> materials_;
    Buffer device_materials_, radiance_;
    Shot shot_;
    GBuffer gbuffer_;
    Tiles tiles_;
    size_t pixels_ = 0;
    std::vector<GBufferTexel> texels_;
    std::vector<uint32_t> isolated_;
};

TEST_F(NativeMerge, IsThatOfTheShader) {
    for (const Shot& shot : table()) {
        const Merged natively = move(shot, true), by_shader = move(shot, false);
        EXPECT_EQ(unlike(natively.alone, by_shader.alone), 0u) << shot.name;
        for (size_t frame = 0; frame < natively.frames.size(); ++frame)
            // A pixel of the last frame may be just of the same surface for one and just not for the other.
            EXPECT_LE(unlike(natively.frames[frame], by_shader.frames[frame]), frame * pixels_ / 500)
                << shot.name << ", frame " << frame;
        if (pixels_ < 10000) continue;
        EXPECT_GT(shown(), pixels_ / 4) << shot.name;
        EXPECT_GT(unlike(by_shader.frames.back(), by_shader.alone), shown() / 2) << shot.name;
        if (shot.interleave > 1) {
            EXPECT_GT(isolated_.size(), 20u) << shot.name;
        }
    }
}

TEST_F(NativeMerge, EveryInstructionSetAndNumberOfThreadsGivesTheSameBits) {
    for (const Shot& shot : table()) {
        const auto expect_same = [&](const Merged& a, const Merged& b, const std::string& what) {
            EXPECT_TRUE(same(a.alone, b.alone)) << shot.name << what;
            for (size_t frame = 0; frame < a.frames.size(); ++frame)
                EXPECT_TRUE(same(a.frames[frame], b.frames[frame]))
                    << shot.name << what << ", frame " << frame;
        };
        gi::native::use_instruction_set(-1);
        const Merged fastest = move(shot, true);
        {
            const ThreadLimit one(1);
            expect_same(fastest, move(shot, true), ", one thread");
        }
        int sets = 0;
        for (; gi::native::use_instruction_set(sets); ++sets)
            expect_same(fastest, move(shot, true), ", set " + std::to_string(sets));
        EXPECT_GE(sets, 1);
    }
}

/// The reflected light of an even irradiance, W/(sr m^2), and how far pixels are off, relative to it.
TEST_F(NativeMerge, EvenLightIsReflectedAsTheAlbedoSays) {
    for (const Shot& shot : table())
        for (const bool natively : {false, true}) {
            draw(shot);
            const auto merged = merge(even_light(3), natively, nullptr);
            for (size_t i = 0; i < pixels_; ++i) {
                const glm::vec3 expected = texels_[i].depth > 0 ? 3.0f / kPi * reflectance(i) : glm::vec3(0);
                ASSERT_LE(glm::distance(glm::vec3(merged[i]), expected), 1e-5f) << shot.name << natively;
                ASSERT_EQ(merged[i].w, 1) << shot.name << natively;
            }
        }
}

TEST_F(NativeMerge, AStandingCameraAveragesItsLastFrames) {
    const Shot shot{"", seen_by(70, 50), 4};
    for (const bool natively : {false, true}) {
        History history;
        float mean = 0;
        for (int frame = 1; frame <= 12; ++frame) {
            draw(shot);
            const auto light = static_cast<float>(frame * frame % 7);
            const auto merged = merge(even_light(light), natively, &history);
            mean += (light - mean) / static_cast<float>(std::min(frame, 8));
            size_t others = 0;
            for (size_t i = 0; i < pixels_; ++i)
                if (texels_[i].depth > 0)
                    others += !(glm::distance(glm::vec3(merged[i]), mean / kPi * reflectance(i)) <= 1e-4f);
            EXPECT_EQ(others, 0u) << frame << natively;
        }
    }
}

/// Depths and light that are no numbers, and pixels that are empty in one frame and shown in the next.
TEST_F(NativeMerge, HandlesNaNAsTheShaderDoes) {
    const Shot shot{"", seen_by(83, 61), 4};
    const auto frames = [&](bool natively) {
        Merged merged;
        History history;
        for (const unsigned frame : {0u, 1u, 2u}) {
            // Away from the middles of pixels, so that no weight is 0 but for rounding.
            Shot moved = shot;
            moved.camera.origin.x += 0.013f * static_cast<float>(frame);
            draw(moved);
            std::vector<GBufferTexel> texels = texels_;
            for (size_t i = 7 * frame; i < pixels_; i += 37) texels[i].depth = frame == 1 ? 0 : kNaN;
            gbuffer_.texels.upload_all(texels);
            with_frame([&](Frame& f) { ASSERT_TRUE(join_tiles(f, false, tiles_)); });
            TileLight light = random_light(frame);
            for (size_t i = 0; i < pixels_; i += 401) light.diffuse[i].y = kNaN;
            light.own[isolated_.front()].x = kNaN;
            merged.frames.push_back(merge(light, natively, frame == 2 ? nullptr : &history));
        }
        return merged;
    };
    const Merged natively = frames(true), by_shader = frames(false);
    for (size_t frame = 0; frame < natively.frames.size(); ++frame) {
        const auto &a = natively.frames[frame], &b = by_shader.frames[frame];
        size_t none = 0, others = 0;
        for (size_t i = 0; i < pixels_; ++i)
            for (int channel = 0; channel < 3; ++channel) {
                none += std::isnan(a[i][channel]);
                others += std::isnan(a[i][channel]) != std::isnan(b[i][channel]);
            }
        EXPECT_GT(none, 0u) << frame;
        EXPECT_LT(none, pixels_ / 4) << frame;
        EXPECT_EQ(others, 0u) << frame;
        EXPECT_LE(unlike(a, b), pixels_ / 50) << frame;
    }
    for (int set = 0; gi::native::use_instruction_set(set); ++set) {
        const Merged again = frames(true);
        for (size_t frame = 0; frame < again.frames.size(); ++frame)
            EXPECT_TRUE(same(again.frames[frame], natively.frames[frame])) << set << ", frame " << frame;
    }
}

}  // namespace
}  // namespace lucarne::gi::vpl
