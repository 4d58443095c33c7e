#include "gi/compare/metrics.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::gi {
namespace {

using Picture = std::vector<glm::vec4>;

glm::vec4 grey(float level) {
    return {level, level, level, 1};
}

TEST(Metrics, EqualPicturesDoNotDiffer) {
    for (const float level : {0.0f, 0.5f}) {
        const Picture picture(10, glm::vec4(level, 2 * level, level, 1));
        const auto metrics = compare_images(picture, picture);
        ASSERT_TRUE(metrics);
        EXPECT_EQ(metrics->luminance_error, 0);
        EXPECT_EQ(metrics->rel_mse, 0);
        EXPECT_EQ(metrics->rel_mse_trimmed, 0);
        EXPECT_EQ(metrics->rmse, 0);
        EXPECT_EQ(metrics->p99, 0);
    }
}

TEST(Metrics, FiguresOfASmallPictureAreThoseWorkedOutByHand) {
    const Picture reference = {glm::vec4(1, 1, 1, 0), glm::vec4(3, 3, 3, 0)};
    const Picture picture = {glm::vec4(1.5f, 1.5f, 1.5f, 9), glm::vec4(3, 3, 3, 7)};
    const auto metrics = compare_images(picture, reference);
    ASSERT_TRUE(metrics);
    EXPECT_NEAR(metrics->mean_luminance, 2.25, 1e-9);
    EXPECT_NEAR(metrics->reference_mean_luminance, 2.0, 1e-9);
    EXPECT_NEAR(metrics->luminance_error, 0.125, 1e-9);
    EXPECT_NEAR(metrics->rmse, std::sqrt(0.125), 1e-9);
    EXPECT_NEAR(metrics->rel_mse, 0.5 * 0.25 / (1 + 0.04), 1e-9);
    EXPECT_NEAR(metrics->p99, std::sqrt(0.25 / 1.04), 1e-9);
    EXPECT_EQ(metrics->pixels, 2u);
    EXPECT_EQ(metrics->trimmed_pixels, 0u);
}

TEST(Metrics, ChannelsCountAlikeInErrorsAndByLuminanceInTheMean) {
    const Picture reference = {glm::vec4(1, 2, 0, 0)}, picture = {glm::vec4(1, 1, 0, 0)};
    const auto metrics = compare_images(picture, reference);
    ASSERT_TRUE(metrics);
    EXPECT_NEAR(metrics->luminance_error, -0.7152 / (0.2126 + 2 * 0.7152), 1e-6);
    EXPECT_NEAR(metrics->rmse, std::sqrt(1.0 / 3), 1e-9);
    EXPECT_NEAR(metrics->rel_mse, 1.0 / 3 / (4 + 0.01), 1e-9);
}

TEST(Metrics, TrimmingLeavesOutTheWorstPixelInAThousandAndNoMore) {
    Picture reference(2000, grey(1)), picture = reference;
    picture[7] = grey(101);  // two fireflies
    picture[1500] = grey(51);
    picture[20] = grey(1.5f);  // an ordinary error
    const auto metrics = compare_images(picture, reference);
    ASSERT_TRUE(metrics);
    EXPECT_EQ(metrics->trimmed_pixels, 2u);
    EXPECT_NEAR(metrics->rel_mse, (10000 + 2500 + 0.25) / 1.01 / 2000, 1e-6);
    EXPECT_NEAR(metrics->rel_mse_trimmed, 0.25 / 1.01 / 1998, 1e-9);
    EXPECT_EQ(metrics->p99, 0);
    for (size_t i = 0; i < 25; ++i) picture[100 + i] = grey(1.1f);  // more than one in a hundred
    EXPECT_NEAR(compare_images(picture, reference)->p99, 0.1 / std::sqrt(1.01), 1e-6);
}

TEST(Metrics, AMaskKeepsTheWholePicturesScale) {
    const Picture reference = {grey(1), grey(3)}, picture = {grey(1.5f), grey(9)};
    const std::vector<uint8_t> first = {1, 0}, none = {0, 0}, short_mask = {1};
    const auto metrics = compare_images(picture, reference, first);
    ASSERT_TRUE(metrics);
    EXPECT_EQ(metrics->pixels, 1u);
    EXPECT_NEAR(metrics->luminance_error, 0.5, 1e-6);
    EXPECT_NEAR(metrics->rel_mse, 0.25 / (1 + 0.04), 1e-9);
    EXPECT_FALSE(compare_images(picture, reference, none));
    EXPECT_FALSE(compare_images(picture, reference, short_mask));
}

TEST(Metrics, HalvesOfASmallReferenceGiveTheFiguresWorkedOutByHand) {
    const Picture picture = {grey(2), grey(1)}, first = {grey(1), grey(1)}, second = {grey(1), grey(3)};
    const auto error = compare_with_halves(picture, first, second);
    ASSERT_TRUE(error);
    // r = 1, 2; m = 1.5; products 1 / (1 + .0225) and 0; noise 0 and 1 / (4 + .0225)
    EXPECT_NEAR(error->rel_mse, 0.5 / 1.0225, 1e-9);
    EXPECT_NEAR(error->standard_error, 0.5 / 1.0225 / std::sqrt(2.0), 1e-9);
    EXPECT_NEAR(error->reference_rel_mse, 0.5 / 4.0225, 1e-9);
}

TEST(Metrics, TrimmedHalvesLeaveOutTheWorstPixels) {
    std::vector<glm::vec4> picture(2000, glm::vec4(1.1f)), reference(2000, glm::vec4(1.0f));
    picture[7] = picture[1234] = glm::vec4(100);
    const auto error = compare_with_halves(picture, reference, reference);
    ASSERT_TRUE(error);
    EXPECT_GT(error->rel_mse, 9);
    EXPECT_NEAR(error->rel_mse_trimmed, .01 / 1.01, 1e-5);
    picture[99] = glm::vec4(100);  // more than one in a thousand
    EXPECT_GT(compare_with_halves(picture, reference, reference)->rel_mse_trimmed, 4);
}

TEST(Metrics, TwoHalvesFreeTheErrorFromTheReferencesNoise) {
    constexpr double kNoise = 0.05, kError = 0.03;
    Random random(5);
    const auto noisy = [&](double level) {  // of variance kNoise^2
        return grey(static_cast<float>(level + kNoise * std::sqrt(12.0) * (random.uniform() - 0.5)));
    };
    Picture picture, first, second, mean;
    for (int i = 0; i < 40000; ++i) {
        picture.push_back(grey(static_cast<float>(i % 2 ? 1 + kError : 1 - kError)));
        first.push_back(noisy(1));
        second.push_back(noisy(1));
        mean.push_back(0.5f * (first.back() + second.back()));
    }
    const auto error = compare_with_halves(picture, first, second);
    ASSERT_TRUE(error);
    const double truth = kError * kError / 1.01, noise = kNoise * kNoise / 2;
    EXPECT_NEAR(error->rel_mse, truth, 4 * error->standard_error + 6 * noise * noise);
    EXPECT_LT(error->standard_error, 0.1 * truth);
    EXPECT_NEAR(error->reference_rel_mse, noise, 0.1 * noise);
    EXPECT_GT(compare_images(picture, mean)->rel_mse, 2 * truth);  // without halves, noise counts
}

TEST(Metrics, PicturesOfOtherSizesOrWithoutFiniteValuesAreRejected) {
    const Picture two(2, glm::vec4(1)), three(3, glm::vec4(1)), none;
    EXPECT_FALSE(compare_images(two, three));
    EXPECT_FALSE(compare_images(none, none));
    EXPECT_FALSE(compare_with_halves(two, two, three));
    EXPECT_FALSE(compare_with_halves(two, three, two));
    Picture bad = two;
    bad[1].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(compare_images(bad, two));
    EXPECT_FALSE(compare_images(two, bad));
    EXPECT_FALSE(compare_with_halves(two, two, bad));
    bad[1].y = std::numeric_limits<float>::infinity();
    EXPECT_EQ(compare_images(bad, two).error().kind, ErrorKind::input_rejected);
}

TEST(Metrics, PixelsThatAreNoNumbersAreCountedAndPlaced) {
    Picture picture(12, grey(1));
    EXPECT_TRUE(check_radiance(picture, 4, "x.exr"));
    picture[6].z = std::numeric_limits<float>::quiet_NaN();
    picture[9].x = picture[9].y = -std::numeric_limits<float>::infinity();
    const auto checked = check_radiance(picture, 4, "x.exr");
    ASSERT_FALSE(checked);
    EXPECT_THAT(
        checked.error().line(),
        testing::HasSubstr("x.exr: 2 of 12 pixels are no finite radiance, the first at column 2, row 1"));
}

}  // namespace
}  // namespace lucarne::gi
