// Work on a scan is kept by itself and found again, see window_fixture.h.
#include <fstream>

#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr, testing::Not;

class WindowWithProject : public ManagedWindow {
 protected:
    void SetUp() override {
        ManagedWindow::SetUp();
        engine_.clear();  // nothing on the command line says what to show
    }
    void close() {
        xdo("key alt+F4");
        ASSERT_TRUE(eventually([&] { return !viewer_->running(); })) << log();
        EXPECT_EQ(viewer_->code(), 0);
    }
    /// The project of the only scan; empty if there is none.
    std::filesystem::path project() const {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / "config/projects", none))
            if (entry.path().extension() == ".json") return entry.path();
        return {};
    }
};

TEST_F(WindowWithProject, IsFoundAgainTheNextDay) {
    start();
    ASSERT_TRUE(picture(lit)) << log();
    close();
    EXPECT_TRUE(project().empty()) << "nothing was changed";

    start();
    const auto home = picture(lit);
    ASSERT_TRUE(home) << log();
    xdo("key 5");
    const auto above = picture([&](const io::Image8& now) { return difference(now, *home) > 2; });
    ASSERT_TRUE(above) << "from the top";
    xdo("key Insert sleep 0.5");  // a key frame
    close();
    EXPECT_THAT(log(), Not(HasSubstr("asked whether to close"))) << "nothing would be lost";
    ASSERT_FALSE(project().empty()) << log();
    EXPECT_THAT(bytes_of(project()), HasSubstr("\"flythrough\""));

    start();
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *above, *home); })) << log();
    EXPECT_THAT(log(), HasSubstr("your work on this scan is shown again"));
    xdo("key Home");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *home, *above); }))
        << "the first view is still there";
    close();

    engine_ = " --engine direct";
    start();
    ASSERT_TRUE(picture(lit)) << log();
    close();
    EXPECT_EQ(log().find("shown again", log().find("shown again") + 1), std::string::npos)
        << "a command line that says what to show is obeyed";
}

TEST_F(WindowWithProject, ThatCannotBeWrittenIsAskedFor) {
    std::filesystem::create_directories(folder_ / "config");
    std::ofstream(folder_ / "config/projects") << "a file where the folder should be";
    start();
    ASSERT_TRUE(picture(lit)) << log();
    xdo("key Insert sleep 0.5 key alt+F4");
    ASSERT_TRUE(eventually([&] { return log().find("asked whether to close") != std::string::npos; }))
        << log();
    xdo("key Return");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); })) << log();
    EXPECT_TRUE(std::filesystem::exists(folder_ / "flythrough.json"));
}

TEST_F(WindowWithProject, WithHostileBytesIsPutAside) {
    start();
    ASSERT_TRUE(picture(lit)) << log();
    xdo("key Insert sleep 0.5");
    close();
    ASSERT_FALSE(project().empty());
    const std::filesystem::path file = project();
    std::ofstream(file) << "{\"version\": 1, \"scene\": {\"cameras\": [{}]}}";
    start();
    ASSERT_TRUE(picture(lit)) << log();
    EXPECT_TRUE(std::filesystem::exists(file.string() + ".broken"));
    close();
}

}  // namespace
}  // namespace lucarne
