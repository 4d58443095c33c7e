#include "gi/post/exposure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "gi/shared/gbuffer.h"
#include "gi/shared/surfel_code.h"
#include "gi/shared/tone_curve.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class ExposureTest : public OnDevice {
 protected:
    /// The exposure of a picture whose first `points` pixels show points.
    Exposure exposed(const std::vector<glm::vec4>& values, size_t points) {
        auto radiance = device->buffer(values.size() * sizeof(glm::vec4), "radiance");
        EXPECT_TRUE(radiance);
        radiance->upload_all(values);
        GBuffer gbuffer;
        gbuffer.width = kWidth;
        gbuffer.height = static_cast<uint32_t>(values.size() / kWidth);
        std::vector<GBufferTexel> texels(values.size());
        for (size_t i = 0; i < points; ++i) texels[i].depth = 1;
        auto made = device->buffer(texels.size() * sizeof(GBufferTexel), "texels");
        EXPECT_TRUE(made);
        made->upload_all(texels);
        gbuffer.texels = std::move(*made);
        const auto found = automatic_exposure(*device, *radiance, gbuffer, ToneMap::filmic);
        EXPECT_TRUE(found);
        return found.value_or(Exposure{-1000, 0});
    }
    Exposure exposed(const std::vector<glm::vec4>& values) { return exposed(values, values.size()); }
    double exposure(std::vector<glm::vec4> values) {
        while (values.size() % kWidth) values.emplace_back(0);  // black pixels do not count
        return exposed(values, 0).ev;
    }
    /// The brightest channel of a grey as it comes out, 0 to 255.
    double shown(float grey, const Exposure& exposure) {
        const float scale = std::exp2(static_cast<float>(exposure.ev));
        return 255 * linear_to_srgb(tone_curve(glm::vec3(grey * scale), 0, exposure.compression).x);
    }

    static constexpr uint32_t kWidth = 40;
};

TEST_F(ExposureTest, AutomaticExposureBringsTheLogAverageToTheKey) {
    std::vector<glm::vec4> picture(1000, glm::vec4(0.25f));
    for (size_t i = 0; i < 500; ++i) picture[i] = glm::vec4(4.0f);
    EXPECT_NEAR(exposure(picture), std::log2(0.18), 1e-4);  // log-average of 1/4 and 4 is 1
    for (auto& v : picture) v *= 8.0f;
    EXPECT_NEAR(exposure(picture), std::log2(0.18 / 8), 1e-4);
}

TEST_F(ExposureTest, TheHostsLogAverageIsTheDevices) {
    std::vector<glm::vec4> values = {{0, 0, 0, 0}, {-1, 0.5f, 1, 0}};
    for (int i = 0; i < 300; ++i) values.emplace_back(0.001f * static_cast<float>(i));
    EXPECT_NEAR(log_average_exposure(values), exposure(values), 1e-4);
}

TEST_F(ExposureTest, BlackPixelsDoNotTurnTheExposureUp) {
    std::vector<glm::vec4> picture(1000, glm::vec4(1.0f));
    const double lit = exposure(picture);
    picture.resize(5000, glm::vec4(0.0f));
    EXPECT_NEAR(exposure(picture), lit, 1e-4);
    picture.resize(5100, glm::vec4(std::numeric_limits<float>::quiet_NaN()));
    EXPECT_NEAR(exposure(picture), lit, 1e-4);
}

TEST_F(ExposureTest, BlackPictureIsNotExposedAtAll) {
    EXPECT_EQ(exposure(std::vector<glm::vec4>(100, glm::vec4(0.0f))), 0.0);
}

TEST_F(ExposureTest, HighlightsOfSurfacesAreShownWithoutClipping) {
    for (const float bright : {2.0f, 8.0f, 60.0f}) {
        std::vector<glm::vec4> picture(40 * 40, glm::vec4(0.05f));
        for (size_t i = 0; i < 40 * 8; ++i) picture[i] = glm::vec4(bright);  // a fifth of the pixels
        const Exposure found = exposed(picture);
        const double by_mean = log_average_exposure(picture);
        EXPECT_LE(found.ev, by_mean);
        EXPECT_GE(found.ev, by_mean - kMostLowered - 1e-4);
        EXPECT_NEAR(shown(bright, found), 244, 1) << bright;
        // What is not in a fifth of the pixels is left to clip.
        for (size_t i = 0; i < 16; ++i) picture[i % 4 + i / 4 * 40] = glm::vec4(1e4f);
        EXPECT_NEAR(shown(bright, exposed(picture)), 244, 1) << bright;
        // Sky is no surface: where the bright part shows no point, the mean decides alone.
        std::reverse(picture.begin(), picture.end());
        const Exposure sky = exposed(picture, 40 * 32);
        EXPECT_NEAR(sky.ev, log_average_exposure(picture), 1e-3);
        EXPECT_EQ(sky.compression, 0);
    }
}

TEST_F(ExposureTest, PictureOfOneBrightnessIsNotLowered) {
    const Exposure found = exposed(std::vector<glm::vec4>(1600, glm::vec4(7)));
    EXPECT_NEAR(found.ev, std::log2(0.18 / 7), 1e-4);
    EXPECT_EQ(found.compression, 0);
}

TEST_F(ExposureTest, StepsLeadFromOneToTheOther) {
    const Exposure a{-2, 0, glm::vec3(1)}, b{4, 3, glm::vec3(1, 1, 2)};
    EXPECT_EQ(between(a, b, 1).ev, b.ev);
    EXPECT_EQ(between(a, b, 0).ev, a.ev);
    EXPECT_EQ(between(a, b, .5).ev, 1);
    EXPECT_EQ(between(a, b, .5).compression, 1.5f);
    EXPECT_EQ(between(a, b, 0).balance, b.balance) << "a white balance is chosen, not measured";
}

TEST_F(ExposureTest, NoisyPixelsAreNoHighlights) {
    std::vector<glm::vec4> picture(1600, glm::vec4(1));
    for (size_t i = 0; i < picture.size(); i += 16)
        picture[i] = glm::vec4(40);  // 6 % of the pixels, scattered
    const Exposure found = exposed(picture);
    EXPECT_GT(found.ev, log_average_exposure(picture) - 0.5);
}

}  // namespace
}  // namespace lucarne::gi
