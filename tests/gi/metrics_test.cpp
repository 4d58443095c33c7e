#include "gi/compare/metrics.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

using Picture = std::vector<glm::vec4>;

TEST(Metrics, EqualPicturesDoNotDiffer) {
    for (const float level : {0.0f, 0.5f}) {
        const Picture picture(10, glm::vec4(level, 2 * level, level, 1));
        const auto metrics = compare_images(picture, picture);
        ASSERT_TRUE(metrics);
        EXPECT_EQ(metrics->luminance_error, 0);
        EXPECT_EQ(metrics->rel_mse, 0);
        EXPECT_EQ(metrics->rmse, 0);
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
}

TEST(Metrics, PicturesOfOtherSizesOrWithoutFiniteValuesAreRejected) {
    const Picture two(2, glm::vec4(1)), three(3, glm::vec4(1)), none;
    EXPECT_FALSE(compare_images(two, three));
    EXPECT_FALSE(compare_images(none, none));
    Picture bad = two;
    bad[1].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(compare_images(bad, two));
    EXPECT_FALSE(compare_images(two, bad));
    bad[1].y = std::numeric_limits<float>::infinity();
    EXPECT_EQ(compare_images(bad, two).error().kind, ErrorKind::input_rejected);
}

}  // namespace
}  // namespace lucarne::gi
