#include "gi/post/fill_gaps.h"

#include <algorithm>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kWidth = 70, kHeight = 45,
                   kReach = 4;  // more than two words a row, parts of words at ends
constexpr uint32_t kPoint = 0xff204060, kBehind = 0xff000000;

class FillGapsTest : public OnDevice {
 protected:
    /// Returns the picture after its gaps were filled. Pixels with `points` have the colour `picture`, which
    /// is kBehind elsewhere.
    std::vector<uint32_t> filled(const std::vector<bool>& points, std::vector<uint32_t> picture,
                                 uint32_t reach = kReach) {
        std::vector<GBufferTexel> texels(points.size());
        std::vector<glm::vec4> radiance(points.size());
        for (size_t i = 0; i < points.size(); ++i) {
            texels[i].depth = points[i] ? 1.0f : 0.0f;
            radiance[i].w = points[i] ? 0.5f : 0.0f;
            if (!points[i]) picture[i] = kBehind;
        }
        std::vector<std::vector<uint32_t>> results;
        for (const bool averaged : {false, true})
            for (const bool natively : {false, true}) {
                device->use_native_passes(natively);
                GBuffer gbuffer;
                gbuffer.width = kWidth;
                gbuffer.height = kHeight;
                gbuffer.texels = uploaded(averaged ? std::vector<GBufferTexel>(points.size()) : texels);
                const Buffer light = uploaded(radiance);
                Buffer shown = uploaded(picture);
                EXPECT_TRUE(fill_gaps(*device, gbuffer, light, averaged, reach, shown));
                results.push_back(shown.download_all<uint32_t>(picture.size()));
                EXPECT_EQ(results.front(), results.back())
                    << (averaged ? "an average" : "one frame") << (natively ? ", natively" : "");
            }
        return results.front();
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

/// Returns how many steps lead from a pixel to the nearest one with points in a direction; 0: none within
/// `reach`.
int steps_to_points(const std::vector<bool>& points, const glm::ivec2& from, const glm::ivec2& direction,
                    int reach) {
    for (int step = 1; step <= reach; ++step) {
        const glm::ivec2 there = from + step * direction;
        if (there.x < 0 || there.y < 0 || there.x >= int(kWidth) || there.y >= int(kHeight)) return 0;
        if (points[static_cast<size_t>(there.y) * kWidth + static_cast<size_t>(there.x)]) return step;
    }
    return 0;
}

TEST_F(FillGapsTest, FillsWhatLiesBetweenPoints) {
    std::vector<bool> points(kWidth * kHeight);
    for (uint32_t y = 0; y < kHeight; ++y)  // squares of two pixels, two apart
        for (uint32_t x = 0; x < kWidth; ++x) points[y * kWidth + x] = x % 4 < 2 && y % 4 < 2;
    const auto picture = filled(points);
    for (uint32_t y = 4; y < kHeight - 4; ++y)
        for (uint32_t x = 4; x < kWidth - 4; ++x)
            EXPECT_EQ(picture[y * kWidth + x], kPoint) << x << ", " << y;
}

TEST_F(FillGapsTest, LooksAlongEightDirectionsAsFarAsItReaches) {
    std::vector<bool> points(kWidth * kHeight);
    for (size_t i = 0; i < points.size(); ++i) points[i] = mix64(i) % 12 == 0;
    for (const int reach : {1, 7, 31, 64}) {
        const auto picture = filled(points, std::vector<uint32_t>(points.size(), kPoint), uint32_t(reach));
        size_t between_points = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            const glm::ivec2 here(int(i % kWidth), int(i / kWidth));
            int between = 0;
            for (const glm::ivec2 axis : {glm::ivec2(1, 0), {0, 1}, {1, 1}, {1, -1}})
                between += steps_to_points(points, here, axis, reach) > 0 &&
                           steps_to_points(points, here, -axis, reach) > 0;
            const bool shown = points[i] || between >= 2;
            between_points += !points[i] && shown;
            ASSERT_EQ(picture[i], shown ? kPoint : kBehind)
                << here.x << ", " << here.y << ", reach " << reach;
        }
        EXPECT_GT(between_points, reach == 1 ? 0 : 20) << "reach " << reach;
    }
}

TEST_F(FillGapsTest, WideOpeningsOutlinesAndEmptyPicturesStay) {
    std::vector<bool> window(kWidth * kHeight, true), half(kWidth * kHeight, false);
    for (uint32_t y = 6; y < 18; ++y)
        for (uint32_t x = 26; x < 38; ++x) window[y * kWidth + x] = false;
    const auto picture = filled(window);
    EXPECT_EQ(picture[12 * kWidth + 32], kBehind) << "12 pixels wide, reached over 4";
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth / 2; ++x) half[y * kWidth + x] = true;
    EXPECT_EQ(empty(filled(half)), kHeight * kWidth / 2);
    EXPECT_EQ(empty(filled(std::vector<bool>(kWidth * kHeight, false))), kWidth * kHeight);
}

TEST_F(FillGapsTest, TheColourIsThatOfTheNearestPointsAround) {
    std::vector<bool> points(kWidth * kHeight, true);
    std::vector<uint32_t> picture(kWidth * kHeight, kPoint);
    const uint32_t hole = 10 * kWidth + 32;  // its row's words end beside it
    points[hole] = false;
    for (uint32_t y = 0; y < kHeight; ++y)
        picture[y * kWidth + 31] = 0xff6080a0;  // three of eight neighbours
    const uint32_t colour = filled(points, picture)[hole];
    // Weighted by the inverse square distance in steps, all eight count alike.
    EXPECT_NEAR(colour & 255u, (5 * 0x60 + 3 * 0xa0) / 8.0, 1);
    EXPECT_NEAR(colour >> 16 & 255u, (5 * 0x20 + 3 * 0x60) / 8.0, 1);
}

}  // namespace
}  // namespace lucarne::gi
