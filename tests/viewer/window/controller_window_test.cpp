// A 6-DoF controller, replayed by umockdev, in a real window.
#include <gtest/gtest.h>

#include "tests/io/input/replayed_controller.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;

TEST_F(ViewerWindow, ASixDofControllerMovesTheCameraAndMayBeUnpluggedInTheMiddle) {
    if (!installed("umockdev-run")) GTEST_SKIP() << "needs umockdev";
    start();
    const auto before = picture(lit);
    ASSERT_TRUE(before);
    xdo("key ctrl+q");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));

    // Reports are replayed as fast as they are requested. There are so many that the push lasts until there
    // is a view, also on a busy machine.
    std::vector<io::test::Answer> answers(40'000, {io::test::axes_report(1, 120, 0, 0)});
    answers.push_back({{}, -19});
    std::string device;
    for (const std::string& word : io::test::under_umockdev(folder_.path(), answers)) device += word + " ";
    start_with(cache_, device);
    const auto after = picture([&](const auto& seen) { return difference(seen, *before) > 5; });
    EXPECT_TRUE(after) << "pushed to the right\n" << log();
    EXPECT_TRUE(viewer_->running()) << "and unplugged";
}

}  // namespace
}  // namespace lucarne
