#include "tests/bench/picture_times.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.h"

namespace lucarne::bench {
namespace {

TEST(PictureTimes, CountOnlySwapsDuringTheDrag) {
    const test::Folder folder;
    const std::string file = folder / "swaps";
    std::ofstream(file) << "1.0\n5.0\n5.1\n5.2\n5.4\n9.0\n";
    const auto times = times_of_swaps(file, 4.9, 6);
    ASSERT_TRUE(times);
    EXPECT_EQ(times->pictures, 4u);
    EXPECT_NEAR(times->median, 100, 1e-6);
    EXPECT_NEAR(times->p95, 200, 1e-6);
    EXPECT_FALSE(times_of_swaps(file, 4.9, 5.1)) << "two pictures are no series";
    EXPECT_FALSE(times_of_swaps(folder / "none", 0, 9));
}

TEST(PictureTimes, OfALogAreThoseOfItsLastLine) {
    const auto times = times_of_log(
        "lucarne: while moving: 3 pictures, 80 ms apart, 95 % within 90 ms\n"
        "lucarne: while moving: 120 pictures, 41.5 ms apart, 95 % within 63.0 ms\n"
        "lucarne: window: 83 frames, each 15.1 ms, 95 % of the last ones within 21.2 ms\n");
    ASSERT_TRUE(times);
    EXPECT_EQ(times->pictures, 120u);
    EXPECT_DOUBLE_EQ(times->median, 41.5);
    EXPECT_DOUBLE_EQ(times->p95, 63);
}

TEST(PictureTimes, OfAnIdleWindowAreAnError) {
    EXPECT_FALSE(times_of_log("lucarne: while moving: 0 pictures, 0.0 ms apart, 95 % within 0.0 ms\n"));
}

TEST(PictureTimes, OfALogWithoutTheLineAreAnError) {
    const auto times = times_of_log("lucarne: window: 83 frames, each 15.1 ms\n");
    ASSERT_FALSE(times);
    EXPECT_NE(times.error().line().find("while moving"), std::string::npos);
}

TEST(SwapTimes, AreAppendedAfterEachSwap) {
    const test::Folder folder;
    const std::string file = folder / "swaps";
    setenv("LUCARNE_SWAP_TIMES", file.c_str(), 1);
    void* const library = dlopen(LUCARNE_SWAP_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    ASSERT_TRUE(library) << dlerror();
    using GlxSwap = void(void*, unsigned long);
    using EglSwap = unsigned(void*, void*);
    auto* const glx = reinterpret_cast<GlxSwap*>(dlsym(library, "glXSwapBuffers"));
    auto* const egl = reinterpret_cast<EglSwap*>(dlsym(library, "eglSwapBuffers"));
    ASSERT_TRUE(glx && egl);
    // No driver is loaded, so nothing is shown.
    const double begin = monotonic_seconds();
    glx(nullptr, 0);
    egl(nullptr, nullptr);
    glx(nullptr, 0);
    const auto times = times_of_swaps(file, begin, monotonic_seconds());
    ASSERT_TRUE(times);
    EXPECT_EQ(times->pictures, 3u);
}

}  // namespace
}  // namespace lucarne::bench
