// Tests that the commands fill holes of scans, tell of it, and can be asked not to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr, testing::Not;

TEST(FillCommand, HolesAreFilledUnlessTheyAreToStay) {
    const test::TemporaryFolder folder;
    const std::string cache = test::make_cornell(folder), plain = folder / "plain.luc";
    EXPECT_THAT(test::lucarne("info " + cache).output, HasSubstr("synthetic_surfels"));
    const test::Outcome converted =
        test::lucarne("convert " + (folder / "cornell.las") + " --no-fill -o " + plain);
    EXPECT_EQ(converted.code, 0) << converted.output;
    EXPECT_THAT(test::lucarne("info " + plain).output, Not(HasSubstr("synthetic_surfels")));

    const auto render = [&](const std::string& input, const std::string& options) {
        const std::string picture = folder / "picture.exr";
        const test::Outcome rendered = test::lucarne(
            "render " + input + " -o " + picture + " --overwrite --engine unlit --size 128x128 --scene " +
            LUCARNE_SOURCE_DIR + "/data/scenes/cornell.json --camera front " + options);
        EXPECT_EQ(rendered.code, 0) << rendered.output;
        return io::read_exr(picture).value().pixels;
    };
    const auto filled = render(cache, ""), open = render(cache, "--open-holes");
    EXPECT_NE(filled, open);
    EXPECT_EQ(open, render(plain, ""));
    // Nothing else changes: only pixels of holes differ.
    size_t different = 0;
    for (size_t i = 0; i < filled.size(); ++i) different += filled[i] != open[i];
    EXPECT_LT(different, filled.size() / 8);
    EXPECT_GT(different, filled.size() / 200);
}

}  // namespace
}  // namespace lucarne::viewer
