#include "gi/lighting/light_gbuffers.h"

#include <gtest/gtest.h>

#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class LightGBuffersTest : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        auto loaded = load_cloud(*device, SurfelCloud(scenes::closed_box(2, 20, glm::vec3(.5f))));
        ASSERT_TRUE(loaded) << loaded.error().line();
        cloud_ = std::move(*loaded);
    }
    /// Returns views from different places in the box.
    std::vector<LightView> views(size_t count) const {
        std::vector<LightView> views;
        for (size_t i = 0; i < count; ++i) {
            const float x = .2f + 1.5f * static_cast<float>(i) / static_cast<float>(count);
            const glm::vec3 eye(x, 1, 1.8f);
            views.push_back({scenes::spot(eye, glm::vec3(1, 1, 0), .6f, .6f, 5), &cloud_->cut, 0,
                             look(eye, glm::vec3(1, 1, 0), 32, 32)});
        }
        return views;
    }
    Result<const GBuffer*> look_at(const LightView& view) { return gbuffers_.look(*device, view); }
    bool missing(const LightView& view) { return *gbuffers_.draw_missing(*device, {view}); }

    std::unique_ptr<LoadedCloud> cloud_;
    LightGBuffers gbuffers_;
};

TEST_F(LightGBuffersTest, ViewsAreHeldUntilTheyChange) {
    const auto all = views(5);
    gbuffers_.begin(*device, all, all.size());
    for (const LightView& view : all) ASSERT_TRUE(look_at(view));
    gbuffers_.begin(*device, all, all.size());
    EXPECT_FALSE(*gbuffers_.draw_missing(*device, all));
    auto moved = all;
    moved[2] = views(6)[1];
    gbuffers_.begin(*device, moved, moved.size());
    EXPECT_TRUE(*gbuffers_.draw_missing(*device, moved));
    EXPECT_FALSE(*gbuffers_.draw_missing(*device, moved)) << "it has been drawn";
}

TEST_F(LightGBuffersTest, ViewsInTurnDoNotPushEachOtherOut) {
    const auto all = views(8);
    const size_t room = 6;
    for (int turn = 0; turn < 3; ++turn) {
        gbuffers_.begin(*device, all, room);
        for (const LightView& view : all) ASSERT_TRUE(look_at(view));
    }
    size_t held = 0;
    for (size_t i = 0; i + 3 < room; ++i) held += !missing(all[i]);
    EXPECT_EQ(held, room - 3);
}

TEST_F(LightGBuffersTest, AnotherStateOfTheCutIsDrawnOnlyWhereItMatters) {
    const auto all = views(1);
    gbuffers_.begin(*device, all, 1);
    const auto before = look_at(all[0]);
    ASSERT_TRUE(before);
    const auto texels = (*before)->texels.download_all<GBufferTexel>(32 * 32);
    auto other = load_cloud(*device, SurfelCloud(scenes::closed_box(1.5f, 20, glm::vec3(.5f))));
    ASSERT_TRUE(other);
    LightView now = all[0];
    now.cut = &(*other)->cut;
    const auto any = gbuffers_.look_at_any_state(*device, now);
    ASSERT_TRUE(any);
    EXPECT_EQ((*any)->texels.download_all<GBufferTexel>(32 * 32)[500].depth, texels[500].depth);
    const auto exact = look_at(now);
    ASSERT_TRUE(exact);
    EXPECT_NE((*exact)->texels.download_all<GBufferTexel>(32 * 32)[500].depth, texels[500].depth);
}

TEST_F(LightGBuffersTest, FewAreHeldWhereMemoryIsShort) {
    device->set_memory_cap(device->memory_used() + (uint64_t{1} << 20));
    const auto all = views(80);
    gbuffers_.begin(*device, all, all.size());
    const uint64_t each = 32 * 32 * (sizeof(GBufferTexel) + sizeof(uint32_t));
    for (const LightView& view : all) ASSERT_TRUE(look_at(view));
    EXPECT_LT(device->memory_used(), device->memory_cap());
    EXPECT_GT(all.size() * each, device->memory_cap() / 3);
}

}  // namespace
}  // namespace lucarne::gi
