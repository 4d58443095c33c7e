// Radiance pictures: their two codings, and hostile files.
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/image/image.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::MemoryFile;

const std::string kHead = "#?RADIANCE\n# by hand\nFORMAT=32-bit_rle_rgbe\n\n";

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int v : values) text.push_back(static_cast<char>(v));
    return text;
}

Result<Image> read(const std::string& content, uint64_t most_pixels = kMostPixels) {
    const MemoryFile file;
    file.set(content);
    return read_hdr(file.path(), most_pixels);
}

/// One line of 8 pixels in runs: red 128 everywhere, green 0 to 7, blue 64, exponent 129.
const std::string kRuns =
    bytes({2, 2, 0, 8, 128 + 8, 128, 8, 0, 1, 2, 3, 4, 5, 6, 7, 128 + 3, 64, 128 + 5, 64, 128 + 8, 129});

TEST(Hdr, FlatPixelsAreMantissaTimesPowerOfTwo) {
    const auto image = read(kHead + "-Y 1 +X 2\n" + bytes({128, 64, 0, 129, 255, 1, 2, 0}));
    ASSERT_TRUE(image) << image.error().line();
    EXPECT_EQ(image->pixels[0], glm::vec4(1, .5f, 0, 1));
    EXPECT_EQ(image->pixels[1], glm::vec4(0, 0, 0, 1));
}

TEST(Hdr, RunsAndCopiesAreUndone) {
    const auto image = read(kHead + "-Y 2 +X 8\n" + kRuns + kRuns);
    ASSERT_TRUE(image) << image.error().line();
    ASSERT_EQ(image->pixels.size(), 16u);
    for (size_t i = 0; i < 16; ++i)
        EXPECT_EQ(image->pixels[i], glm::vec4(1, static_cast<float>(i % 8) / 128, .5f, 1)) << i;
}

TEST(Hdr, ExposureOfTheHeaderIsTakenOut) {
    const auto image = read("#?RGBE\nEXPOSURE=2\nEXPOSURE=4\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" +
                            bytes({128, 0, 0, 132}));
    ASSERT_TRUE(image) << image.error().line();
    EXPECT_EQ(image->pixels[0].x, 1.0f);
}

TEST(Hdr, WhatIsNoneOrLiesIsRejectedWithItsReason) {
    const std::pair<std::string, const char*> bad[] = {
        {"", "no Radiance picture"},
        {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "no end"},
        {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n0000", "not RGBE"},
        {"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n0000", "exposure"},
        {kHead + "+X 1 -Y 1\n0000", "size"},
        {kHead + "-Y 99999999 +X 99999999\n0000", "size"},
        {kHead + "-Y 16384 +X 16384\n0000", "too large: at most 67108864 in all"},
        {kHead + "-Y 4096 +X 4096\n0000", "shorter"},
        {kHead + "-Y 1 +X 8\n" + bytes({2, 2, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0}), "another width"},
        {kHead + "-Y 1 +X 8\n" + bytes({2, 2, 0, 8, 128 + 9, 1, 0, 0, 0, 0, 0, 0}), "does not fit"},
        {kHead + "-Y 1 +X 8\n" + bytes({2, 2, 0, 8, 0, 1, 0, 0, 0, 0, 0, 0}), "does not fit"},
        {kHead + "-Y 1 +X 2\n" + bytes({5, 5, 5, 129, 1, 1, 1, 3}), "1991"},
    };
    for (const auto& [content, reason] : bad) {
        const auto image = read(content);
        ASSERT_FALSE(image) << reason;
        EXPECT_EQ(image.error().kind, ErrorKind::input_rejected) << reason;
        EXPECT_THAT(image.error().line(), HasSubstr(reason));
    }
    EXPECT_FALSE(read(kHead + "-Y 1 +X 8\n" + kRuns, 7));
}

TEST(Hdr, TruncatedAndChangedFilesNeverCrash) {
    const std::string whole = kHead + "-Y 2 +X 8\n" + kRuns + kRuns;
    for (size_t length = 0; length < whole.size(); ++length)
        EXPECT_FALSE(read(whole.substr(0, length))) << length;
    for (size_t at = 0; at < whole.size(); ++at)
        for (const int value : {0, 1, 127, 129, 255}) {
            std::string changed = whole;
            changed[at] = static_cast<char>(value);
            (void)read(changed);
        }
}

}  // namespace
}  // namespace lucarne::io
