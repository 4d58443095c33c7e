// Lost contexts and damaged caches in a real window, see window_fixture.h.
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;

class RecoveringWindow : public ViewerWindow {};

TEST_F(RecoveringWindow, GoesOnWithTheSamePictureAfterDeviceAndWindowWereLost) {
    start();
    const auto first = picture(lit);
    ASSERT_TRUE(first);
    viewer_.reset();
    start_with(cache_, "LUCARNE_TEST_LOSE_CONTEXT=2 LUCARNE_TEST_LOSE_WINDOW=10");
    for (const char* loss : {"graphics device: its context was lost", "has lost the window"}) {
        ASSERT_TRUE(eventually([&] { return log().find(loss) != std::string::npos; })) << loss << '\n'
                                                                                       << log();
    }
    // Either picture may be the average of any number of frames: they differ by 14 of 255 at most, pictures
    // without this light by 77, black ones by 140.
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) < 35; })) << log();
    xdo("key ctrl+q");
    EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
}

TEST_F(RecoveringWindow, SaysThatItHasGivenUpAfterThreeTriesAndStillCloses) {
    start_with(cache_, "LUCARNE_TEST_LOSE_CONTEXT=1,1,1,1");
    ASSERT_TRUE(eventually([&] { return log().find("There are no more pictures") != std::string::npos; }))
        << log();
    EXPECT_TRUE(viewer_->running());
    xdo("key ctrl+q");
    EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
}

}  // namespace
}  // namespace lucarne
