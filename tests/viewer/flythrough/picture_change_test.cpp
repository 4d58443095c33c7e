#include "viewer/flythrough/picture_change.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

constexpr ImageSize kSize{50, 34};  // no multiple of a tile

std::vector<std::byte> grey(unsigned value) {
    return std::vector<std::byte>(size_t{kSize.width} * kSize.height * 4, static_cast<std::byte>(value));
}

TEST(PictureChange, OfEqualPicturesIsNothingAndOfBlackToWhiteAll) {
    EXPECT_EQ(change_between(grey(9), grey(9), kSize).whole, 0);
    const PictureChange all = change_between(grey(0), grey(255), kSize);
    EXPECT_NEAR(all.whole, 1, 1e-12);
    EXPECT_NEAR(all.tile, 1, 1e-12);
}

TEST(PictureChange, ASmallPatchThatPopsShowsInItsTile) {
    const auto before = grey(100);
    auto now = before;
    for (size_t y = 32; y < 34; ++y)  // the lower right corner: a tile of 2 x 2 pixels
        for (size_t x = 48; x < 50; ++x)
            for (size_t channel = 0; channel < 3; ++channel)
                now[4 * (y * kSize.width + x) + channel] = std::byte{151};
    const PictureChange change = change_between(before, now, kSize);
    EXPECT_NEAR(change.tile, 0.2, 1e-12);
    EXPECT_NEAR(change.whole, 0.2 * std::sqrt(4.0 / (50 * 34)), 1e-12);
    for (size_t i = 3; i < now.size(); i += 4) now[i] = std::byte{0};
    EXPECT_EQ(change_between(before, now, kSize).whole, change.whole) << "alpha is not seen";
}

}  // namespace
}  // namespace lucarne::viewer
