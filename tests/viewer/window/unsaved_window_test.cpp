// Closes windows with unsaved work, see window_fixture.h.
#include <fstream>

#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

class WindowWithWork : public ManagedWindow {
 protected:
    /// Adds a key frame and puts a light at the camera.
    void work() {
        start();
        ASSERT_TRUE(picture(lit));
        xdo("key Insert sleep 0.5 key l sleep 0.5");
    }
    bool asks(int times) const {
        return eventually([&] { return count("asked whether to close") >= times; });
    }
    int count(const std::string& part) const {
        int times = 0;
        const std::string text = log();
        for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++times;
        return times;
    }
    bool ends() {
        return eventually([&] { return !viewer_->running(); });
    }
    bool there(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
};

TEST_F(WindowWithWork, AsksAndStaysAndThenSavesAll) {
    work();
    xdo("key ctrl+q");
    ASSERT_TRUE(asks(1)) << log();
    EXPECT_THAT(log(), HasSubstr("not saved: a flythrough of 1 key frame, the scene"));
    xdo("key Escape");
    EXPECT_TRUE(picture(lit)) << "F12 saves no picture while it asks";
    EXPECT_FALSE(there("flythrough.json"));
    xdo("key alt+F4");
    ASSERT_TRUE(asks(2)) << "the window manager's closing asks, too\n" << log();
    xdo("key Return");
    ASSERT_TRUE(ends()) << log();
    EXPECT_EQ(viewer_->code(), 0);
    EXPECT_TRUE(there("flythrough.json"));
    EXPECT_TRUE(there("scene-0001.json"));
}

TEST_F(WindowWithWork, DropsAllWhereTheUserSaysSo) {
    work();
    xdo("key ctrl+q");
    ASSERT_TRUE(asks(1)) << log();
    xdo("key ctrl+d");
    ASSERT_TRUE(ends()) << log();
    EXPECT_EQ(viewer_->code(), 0);
    EXPECT_FALSE(there("flythrough.json"));
    EXPECT_FALSE(there("scene-0001.json"));
}

TEST_F(WindowWithWork, KeepsItWhenItsScansAreClosed) {
    work();
    xdo("key ctrl+w");
    ASSERT_TRUE(title_comes("No scan open"));
    xdo("key ctrl+q");
    ASSERT_TRUE(asks(1)) << log();
    xdo("key Return");
    ASSERT_TRUE(ends()) << log();
    EXPECT_TRUE(there("flythrough.json"));
}

TEST_F(WindowWithWork, ClosesAtOnceWhenAllIsSaved) {
    work();
    xdo("key alt+s key ctrl+s sleep 1");
    ASSERT_TRUE(eventually([&] {
        xdo("key Return sleep 0.3");  // the question for a name; a key that comes before it is lost
        return there("flythrough.json") && there("cornell-scene.json");
    })) << log();
    EXPECT_THAT(log(), HasSubstr("saved " + (folder_ / "cornell-scene.json")));
    xdo("key ctrl+q");
    ASSERT_TRUE(ends()) << log();
    EXPECT_EQ(count("asked whether to close"), 0);
}

TEST_F(WindowWithWork, ToldToEndSavesBesideFilesThatAreThereAndAsksNothing) {
    std::ofstream(folder_ / "flythrough.json") << "mine";
    work();
    kill(viewer_->pid(), SIGTERM);
    ASSERT_TRUE(ends()) << log();
    EXPECT_EQ(viewer_->code(), 0);
    EXPECT_EQ(count("asked whether to close"), 0);
    EXPECT_EQ(bytes_of(folder_ / "flythrough.json"), "mine");
    EXPECT_TRUE(there("flythrough-0001.json"));
    EXPECT_THAT(log(), HasSubstr("saved " + (folder_ / "flythrough-0001.json")));
}

}  // namespace
}  // namespace lucarne
