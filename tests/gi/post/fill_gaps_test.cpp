#include "gi/post/fill_gaps.h"

#include <algorithm>
#include <vector>

#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kSize = 24, kReach = 4;
constexpr uint32_t kPoint = 0xff204060, kBehind = 0xff000000;

class FillGapsTest : public OnDevice {
 protected:
    /// Returns the picture after its gaps were filled. Pixels with `points` have the colour `picture`, which
    /// is kBehind elsewhere.
    std::vector<uint32_t> filled(const std::vector<bool>& points, std::vector<uint32_t> picture) {
        std::vector<GBufferTexel> texels(points.size());
        std::vector<glm::vec4> radiance(points.size());
        for (size_t i = 0; i < points.size(); ++i) {
            texels[i].depth = points[i] ? 1.0f : 0.0f;
            radiance[i].w = points[i] ? 0.5f : 0.0f;
            if (!points[i]) picture[i] = kBehind;
        }
        std::vector<uint32_t> results[2];
        for (const bool averaged : {false, true}) {
            GBuffer gbuffer;
            gbuffer.width = gbuffer.height = kSize;
            gbuffer.texels = uploaded(averaged ? std::vector<GBufferTexel>(points.size()) : texels);
            const Buffer light = uploaded(radiance);
            Buffer shown = uploaded(picture);
            EXPECT_TRUE(fill_gaps(*device, gbuffer, light, averaged, kReach, shown));
            results[averaged] = shown.download_all<uint32_t>(picture.size());
        }
        EXPECT_EQ(results[0], results[1]) << "of one frame and of an average";
        return results[0];
    }
    std::vector<uint32_t> filled(const std::vector<bool>& points) {
        return filled(points, std::vector<uint32_t>(points.size(), kPoint));
    }
    static size_t empty(const std::vector<uint32_t>& picture) {
        return static_cast<size_t>(std::ranges::count(picture, kBehind));
    }

 private:
    template <class T>
    Buffer uploaded(const std::vector<T>& values) {
        auto made = device->buffer(values.size() * sizeof(T), "test");
        EXPECT_TRUE(made);
        made->upload_all(values);
        return std::move(*made);
    }
};

TEST_F(FillGapsTest, FillsWhatLiesBetweenPoints) {
    std::vector<bool> points(kSize * kSize);
    for (uint32_t y = 0; y < kSize; ++y)  // squares of two pixels, two apart
        for (uint32_t x = 0; x < kSize; ++x) points[y * kSize + x] = x % 4 < 2 && y % 4 < 2;
    const auto picture = filled(points);
    for (uint32_t y = 4; y < kSize - 4; ++y)
        for (uint32_t x = 4; x < kSize - 4; ++x) EXPECT_EQ(picture[y * kSize + x], kPoint) << x << ", " << y;
}

TEST_F(FillGapsTest, WideOpeningsOutlinesAndEmptyPicturesStay) {
    std::vector<bool> window(kSize * kSize, true), half(kSize * kSize, false);
    for (uint32_t y = 6; y < 18; ++y)
        for (uint32_t x = 6; x < 18; ++x) window[y * kSize + x] = false;
    const auto picture = filled(window);
    EXPECT_EQ(picture[12 * kSize + 12], kBehind) << "12 pixels wide, reached over 4";
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize / 2; ++x) half[y * kSize + x] = true;
    EXPECT_EQ(empty(filled(half)), kSize * kSize / 2);
    EXPECT_EQ(empty(filled(std::vector<bool>(kSize * kSize, false))), kSize * kSize);
}

TEST_F(FillGapsTest, TheColourIsThatOfTheNearestPointsAround) {
    std::vector<bool> points(kSize * kSize, true);
    std::vector<uint32_t> picture(kSize * kSize, kPoint);
    const uint32_t hole = 10 * kSize + 10;
    points[hole] = false;
    for (uint32_t y = 0; y < kSize; ++y) picture[y * kSize + 9] = 0xff6080a0;  // three of eight neighbours
    const uint32_t colour = filled(points, picture)[hole];
    // Weighted by the inverse square distance in steps, all eight count alike.
    EXPECT_NEAR(colour & 255u, (5 * 0x60 + 3 * 0xa0) / 8.0, 1);
    EXPECT_NEAR(colour >> 16 & 255u, (5 * 0x20 + 3 * 0x60) / 8.0, 1);
}

}  // namespace
}  // namespace lucarne::gi
