// Closes windows in the middle of a conversion, see window_fixture.h.
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

class ConvertingWindow : public ManagedWindow {
 protected:
    /// `close`: the keys that close the window. If the conversion ends before the window is closed, there is
    /// no question.
    void asks_stays_closes_and_goes_on(const std::string& close) {
        ASSERT_EQ(lucarne("generate nave --points 600k -o " + scan()).code, 0);
        start_with(scan());
        ASSERT_TRUE(eventually([&] {
            const std::string now = title();
            return now.find("normals") != std::string::npos || now.find("building") != std::string::npos ||
                   cached();
        }));
        xdo("key " + close);
        ASSERT_TRUE(eventually([&] { return asked() == 1 || cached(); })) << "it does not ask";
        if (asked() == 1) {
            xdo("key Escape");
            EXPECT_TRUE(picture(lit)) << "F12 saves no picture while it asks";
            xdo("key " + close);
            ASSERT_TRUE(eventually([&] { return asked() == 2 || cached(); })) << "it does not ask again";
        }
        if (!cached()) xdo("key Return");
        const bool ends = eventually([&] { return !viewer_->running() || cached(); });
        ASSERT_TRUE(ends);
        const bool interrupted = !cached();
        RecordProperty("interrupted", interrupted);
        if (interrupted) {
            EXPECT_EQ(viewer_->code(), 0);
        }
        viewer_.reset();
        start_with(scan());
        ASSERT_TRUE(eventually([&] { return cached(); })) << log();
        if (interrupted) {
            EXPECT_THAT(log(), HasSubstr("going on after"));
        }
    }
    std::string scan() const { return folder_ / "large.las"; }
    bool cached() const { return std::filesystem::exists(scan() + ".luc"); }
    int asked() const {
        int times = 0;
        const std::string text = log();
        for (size_t at = text.find("asked whether to close"); at != std::string::npos;
             at = text.find("asked whether to close", at + 1))
            ++times;
        return times;
    }
};

TEST_F(ConvertingWindow, AsksWhenItIsToQuitAndTheNextOneGoesOn) {
    asks_stays_closes_and_goes_on("ctrl+q");
}

TEST_F(ConvertingWindow, AsksWhenTheWindowManagerClosesItAndTheNextOneGoesOn) {
    asks_stays_closes_and_goes_on("alt+F4");
}

}  // namespace
}  // namespace lucarne
