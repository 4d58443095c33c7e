#include "viewer/light/darkness.h"

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

/// A picture whose first pixels show points. Of these, the first `lit` are mid-grey and the others black; the
/// background is white.
Picture picture(size_t points, size_t lit) {
    Picture made;
    made.size = {20, 10};
    made.depth.assign(200, 0);
    made.rgba.assign(800, std::byte{255});
    for (size_t i = 0; i < points; ++i) {
        made.depth[i] = 3;
        for (size_t c = 0; c < 3; ++c) made.rgba[4 * i + c] = i < lit ? std::byte{128} : std::byte{0};
    }
    return made;
}

TEST(Darkness, IsAPictureOfPointsOfWhichHardlyOneIsLit) {
    EXPECT_TRUE(is_dark(picture(200, 0)));
    EXPECT_TRUE(is_dark(picture(100, 0))) << "whatever the background";
    EXPECT_TRUE(is_dark(picture(200, 3))) << "a speck";
    EXPECT_FALSE(is_dark(picture(200, 4)));
    EXPECT_FALSE(is_dark(picture(0, 0))) << "nothing to light";
    EXPECT_FALSE(is_dark({}));
}

}  // namespace
}  // namespace lucarne::viewer
