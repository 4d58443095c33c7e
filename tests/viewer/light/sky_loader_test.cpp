#include "viewer/light/sky_loader.h"

#include <atomic>

#include <gmock/gmock.h>

#include "io/image/image.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne::viewer {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

std::string sky_file(const TemporaryFolder& folder, const std::string& name, uint32_t width) {
    io::Image image;
    image.width = width;
    image.height = width / 2;
    image.pixels.assign(size_t{image.width} * image.height, glm::vec4(1, 2, 3, 1));
    EXPECT_TRUE(io::write_exr(folder / name, image, true)) << name;
    return folder / name;
}

SkyLoader::Sky taken(SkyLoader& loader) {
    std::optional<SkyLoader::Sky> sky;
    EXPECT_TRUE(test::eventually([&] { return (sky = loader.take()).has_value(); }));
    return sky ? *sky : failed("no sky", "it never comes");
}

TEST(SkyLoader, ReadsAPictureWhileItsCallerGoesOnAndTellsWhenItIsThere) {
    const TemporaryFolder folder;
    std::atomic<int> told = 0;
    SkyLoader loader([&] { ++told; });
    EXPECT_FALSE(loader.take());
    EXPECT_EQ(loader.reading(), "");
    loader.load(sky_file(folder, "sky.exr", 64));
    const auto sky = taken(loader);
    ASSERT_TRUE(sky) << sky.error().line();
    EXPECT_EQ((*sky)->width, 64u);
    EXPECT_EQ((*sky)->texels.front(), glm::vec3(1, 2, 3));
    EXPECT_FALSE(loader.take()) << "once";
    EXPECT_EQ(loader.reading(), "");
    EXPECT_TRUE(test::eventually([&] { return told == 1; }));
}

TEST(SkyLoader, OfManyWishesTheNewestIsTheOneThatComes) {
    const TemporaryFolder folder;
    SkyLoader loader([] {});
    const std::string last = sky_file(folder, "last.exr", 32);
    for (int i = 0; i < 50; ++i) loader.load(sky_file(folder, "one.exr", 256));
    loader.load(last);
    const auto sky = taken(loader);
    ASSERT_TRUE(sky);
    EXPECT_EQ((*sky)->width, 32u);
    EXPECT_FALSE(loader.take());
}

TEST(SkyLoader, WhatCannotBeReadIsAnErrorThatNamesTheFile) {
    const TemporaryFolder folder;
    SkyLoader loader([] {});
    loader.load(folder / "none.hdr");
    const auto none = taken(loader);
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().line(), HasSubstr("none.hdr"));
    loader.load(sky_file(folder, "sky.exr", 16));
    EXPECT_TRUE(taken(loader)) << "the next one is read as ever";
}

}  // namespace
}  // namespace lucarne::viewer
