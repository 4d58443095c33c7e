// The native passes against each other, for every instruction set, and against the shaders.
#include "gi/raster/native/native.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <string>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

struct Shown {
    std::string name;
    std::vector<Surfel> surfels;
    CameraView view;
    PointSize size;
};

CameraView orthographic() {
    CameraView view{};
    view.origin = {0, 0, 0, 0.01f};
    view.forward = {0, 1, 0, 0};
    view.right = {2, 0, 0, 0.3f};
    view.up = {0, 0, 1.5f, -0.2f};
    view.width = 200;
    view.height = 150;
    view.projection = kOrthographic;
    return view;
}

/// Walls at several depths with noise, some without normals or seen from behind, with another material, and
/// discs that surround the eye.
std::vector<Surfel> clutter(float spacing) {
    auto surfels = wall(2, 1.5f, spacing, kWhite, 1);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (Surfel& s : surfels) {
        s.position.y += 0.1f * spacing * uniform(random) + 0.3f * s.position.x;
        s.albedo *= 0.5f + 0.5f * std::abs(uniform(random));
        if (random() % 8 == 0) s.normal = -s.normal;
        if (random() % 16 == 0) s.normal = glm::vec3(0);
        s.material = s.position.z > 0.5f ? 3 : 0;
    }
    auto behind = wall(3, 3, 2 * spacing, kRed, 2);
    append(surfels, behind);
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 at(uniform(random), uniform(random), uniform(random));
        surfels.push_back({0.5f * at, glm::normalize(at), kWhite, 0, 0.002f + 0.01f * std::abs(at.x), 0});
    }
    // Seen edge-on, and smaller than a pixel.
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 at(uniform(random), 1.2f, uniform(random));
        surfels.push_back({at, glm::normalize(glm::cross(at, glm::vec3(0, 0, 1))), kRed, 0, 1e-3f, 0});
        surfels.push_back({at * 0.9f, {0, -1, 0}, kWhite, 0, 1e-8f, 0});
    }
    return surfels;
}

std::vector<Shown> table() {
    const CameraView camera = look({0, 0, 0}, {0.1f, 1, 0.05f}, 301, 203, 0.9f);
    CameraView shifted = camera;
    shifted.right.w = 0.41f;
    shifted.up.w = -0.27f;
    const Light spot{{0, -1, 0.5f, std::cos(0.7f)}, {0, 1, 0, 1}, {1, 1, 1, 0}};
    return {
        {"small discs", clutter(0.008f), camera, {}},
        {"discs of some pixels", clutter(0.03f), shifted, {}},
        {"large discs", clutter(0.2f), camera, {}},
        {"orthographic", clutter(0.02f), orthographic(), {}},
        {"a spot's view", clutter(0.02f), spot_view(spot, 256), {}},
        {"points of three pixels", clutter(0.02f), camera, {.scale = 1, .pixels = 3}},
        {"points of fifty pixels", clutter(0.1f), camera, {.scale = 1, .pixels = 50}},
        {"discs of six pixels at most", clutter(0.1f), camera, {.scale = 1, .most = 6}},
        {"front sides only", clutter(0.03f), camera, {.front_only = true}},
        {"front sides of points of three pixels", clutter(0.02f), camera, {.pixels = 3, .front_only = true}},
        {"half the radii", clutter(0.02f), camera, {.scale = 0.5f}},
        {"one pixel", clutter(0.05f), look({0, 0, 0}, {0, 1, 0}, 1, 1, 0.9f), {}}};
}

class NativePasses : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device->native_passes()) GTEST_SKIP() << "no native passes on this device";
    }
    void TearDown() override {
        native::use_instruction_set(-1);
        OnDevice::TearDown();
    }
    /// Loads surfels; pictures of them are drawn until the next call.
    void load(const std::vector<Surfel>& surfels) {
        const SurfelCloud cloud(surfels, {{-32, -32, -32}, 64}, 512);
        auto loaded = load_cloud(*device, cloud);
        ASSERT_TRUE(loaded) << loaded.error().line();
        loaded_ = std::move(*loaded);
    }
    Picture draw(const CameraView& view, const PointSize& size, bool blended) {
        GBuffer target;
        EXPECT_TRUE(rasterize(*device, loaded_->cut, view, target, size));
        if (blended) {
            EXPECT_TRUE(blend(*device, loaded_->cut, view, target, size));
        }
        const size_t pixels = size_t{view.width} * view.height;
        return {view,
                target.texels.download_all<GBufferTexel>(pixels),
                target.ids.download_all<uint32_t>(pixels),
                {}};
    }

 private:
    std::unique_ptr<LoadedCloud> loaded_;
};

bool same(const Picture& a, const Picture& b) {
    return a.ids == b.ids &&
           std::memcmp(a.texels.data(), b.texels.data(), a.texels.size() * sizeof(GBufferTexel)) == 0;
}

TEST_F(NativePasses, EveryInstructionSetAndNumberOfThreadsGivesTheSameBits) {
    const std::vector<Shown> pictures = table();
    for (const Shown& shown : pictures) {
        load(shown.surfels);
        for (const bool blended : {false, true}) {
            native::use_instruction_set(-1);
            const Picture fastest = draw(shown.view, shown.size, blended);
            {
                const ThreadLimit one(1);
                EXPECT_TRUE(same(fastest, draw(shown.view, shown.size, blended)))
                    << shown.name << ", one thread";
            }
            int sets = 0;
            for (; native::use_instruction_set(sets); ++sets)
                EXPECT_TRUE(same(fastest, draw(shown.view, shown.size, blended)))
                    << shown.name << (blended ? ", blended, set " : ", set ") << sets;
            EXPECT_GE(sets, 1);
        }
    }
}

/// Both round differently in the last bits, so discs at almost the same depth may change places, and so may
/// the pixels at their rims.
TEST_F(NativePasses, GiveThePictureOfTheShaders) {
    for (const Shown& shown : table()) {
        load(shown.surfels);
        for (const bool blended : {false, true}) {
            device->use_native_passes(false);
            const Picture by_shaders = draw(shown.view, shown.size, blended);
            device->use_native_passes(true);
            const Picture natively = draw(shown.view, shown.size, blended);
            size_t others = 0, far = 0, turned = 0, coloured = 0;
            const size_t pixels = by_shaders.ids.size();
            for (size_t at = 0; at < pixels; ++at) {
                if (by_shaders.ids[at] != natively.ids[at]) {
                    ++others;
                    continue;
                }
                if (by_shaders.empty(at)) continue;
                const GBufferTexel &a = by_shaders.texels[at], &b = natively.texels[at];
                // Blended depths are sums of integers.
                const float step = blended ? 2e-3f * glm::unpackHalf2x16(a.material).y : 0.0f;
                far += !(std::abs(a.depth - b.depth) <= 2e-5f * std::abs(a.depth) + step);
                turned += !(glm::distance(decode_octahedral(a.normal), decode_octahedral(b.normal)) < 2e-3f);
                coloured += !(glm::distance(decode_albedo(a.albedo), decode_albedo(b.albedo)) < 4e-3f) ||
                            a.material != b.material;
            }
            const std::string what = shown.name + (blended ? ", blended" : "");
            EXPECT_LE(others, pixels / 500) << what;
            EXPECT_LE(far, pixels / 500) << what;
            EXPECT_LE(turned, pixels / 300) << what;
            EXPECT_LE(coloured, pixels / 500) << what;
        }
    }
}

TEST_F(NativePasses, HostilePositionsGiveADefinedPicture) {
    const float huge = std::numeric_limits<float>::max();
    std::vector<Surfel> surfels = clutter(0.1f);
    for (size_t i = 0; i < surfels.size(); i += 3) surfels[i].area = i % 2 ? huge : 0.0f;
    load(surfels);
    for (const glm::vec3& eye : {glm::vec3(0), glm::vec3(1e6f), glm::vec3(0.1f, 2.0f, 0.1f)}) {
        CameraView view = look(eye, eye + glm::vec3(0, 1, 0), 64, 64, 0.9f);
        EXPECT_TRUE(same(draw(view, {}, true), draw(view, {}, true)));
        view.origin.x = std::numeric_limits<float>::quiet_NaN();
        const Picture p = draw(view, {}, true);
        for (size_t at = 0; at < p.ids.size(); ++at) ASSERT_TRUE(p.empty(at));
    }
}

}  // namespace
}  // namespace lucarne::gi
