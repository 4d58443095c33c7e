// Scans of a single point or two, whose discs are as large as the scan.
#include <algorithm>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

/// The columns and rows of a picture in which red or green points are seen.
struct Seen {
    uint32_t left = ~0u, right = 0, top = ~0u, bottom = 0;
    size_t red = 0, green = 0;
};

Seen seen(const std::string& points) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "few.xyz") << points;
    const test::Outcome ran = test::lucarne("render " + (folder / "few.xyz") + " --no-cache -o " +
                                            (folder / "few.png") + " --size 160x120");
    EXPECT_EQ(ran.code, 0) << ran.output;
    const auto picture = io::read_png(folder / "few.png");
    Seen found;
    if (!picture) return found;
    for (uint32_t y = 0; y < picture->height; ++y)
        for (uint32_t x = 0; x < picture->width; ++x) {
            const uint8_t* pixel = picture->bytes.data() + 3 * (size_t{y} * picture->width + x);
            const bool red = pixel[0] > pixel[1] + 60, green = pixel[1] > pixel[0] + 60;
            found.red += red;
            found.green += green;
            if (!red && !green) continue;
            found.left = std::min(found.left, x);
            found.right = std::max(found.right, x);
            found.top = std::min(found.top, y);
            found.bottom = std::max(found.bottom, y);
        }
    return found;
}

TEST(FewPoints, ASinglePointIsSeen) {
    const Seen one = seen("500005 5000006 7 255 0 0\n");
    EXPECT_GT(one.red, 0u);
}

TEST(FewPoints, TheDiscsOfTwoAreWhollyInThePicture) {
    for (const char* apart : {"10000000", "0.5"}) {
        const Seen two = seen("0 0 0 255 0 0\n" + std::string(apart) + " 0 0 0 255 0\n");
        EXPECT_GT(two.red, 0u) << apart;
        EXPECT_GT(two.green, 0u) << apart;
        EXPECT_GT(two.left, 0u) << apart;
        EXPECT_LT(two.right, 159u) << apart;
        EXPECT_GT(two.top, 0u) << apart;
        EXPECT_LT(two.bottom, 119u) << apart;
    }
}

}  // namespace
}  // namespace lucarne
