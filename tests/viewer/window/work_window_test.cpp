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
    /// Presses Return until `done` is true: a key that comes before its dialog is open is lost.
    template <class Done>
    bool confirmed(const Done& done) {
        return eventually([&] {
            xdo("key Return sleep 0.3");
            return done();
        });
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

TEST_F(WindowWithProject, StepsBackThroughAllFeaturesInTheOrderOfTheirChanges) {
    start();
    const auto whole = picture(lit);
    ASSERT_TRUE(whole) << log();
    xdo("key i sleep 0.5");  // a clip box
    const auto clipped = picture([&](const io::Image8& now) { return difference(now, *whole) > 2; });
    ASSERT_TRUE(clipped) << log();
    xdo("key Insert sleep 0.5 key ctrl+z sleep 0.5 key ctrl+z");  // a key frame, which goes first
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *whole, *clipped); })) << log();
    xdo("key ctrl+shift+z");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *clipped, *whole); })) << log();
    close();
    EXPECT_THAT(bytes_of(project()), Not(HasSubstr("\"flythrough\"")));
}

TEST_F(WindowWithProject, IsSavedUnderANameAndFindsScansThatWereMovedWithIt) {
    const std::string file = folder_ / "cornell-project.json", moved = folder_ / "moved";
    start();
    const auto home = picture(lit);
    ASSERT_TRUE(home) << log();
    xdo("key 5");
    const auto above = picture([&](const io::Image8& now) { return difference(now, *home) > 2; });
    ASSERT_TRUE(above) << log();
    xdo("key ctrl+shift+s");
    ASSERT_TRUE(confirmed([&] { return std::filesystem::exists(file); })) << log();
    xdo("sleep 0.5 key i sleep 0.5");  // a clip box, kept in the same file
    close();
    EXPECT_THAT(bytes_of(file), HasSubstr("\"clip\""));
    EXPECT_THAT(bytes_of(folder_ / "config/settings.json"), HasSubstr(file));

    std::filesystem::create_directory(moved);
    std::filesystem::rename(cache_, moved + "/cornell.luc");
    std::filesystem::rename(file, moved + "/p.json");
    std::filesystem::remove_all(folder_ / "config/projects");
    start_with(moved + "/p.json");
    const auto clipped = picture([&](const io::Image8& now) { return difference(now, *above) > 2; });
    ASSERT_TRUE(clipped) << log();
    xdo("key alt+i");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *above, *home); })) << log();
    close();
    EXPECT_THAT(bytes_of(moved + "/p.json"), HasSubstr(moved + "/cornell.luc")) << "their new place";
    EXPECT_TRUE(project().empty()) << "its own file is enough";

    const Outcome two = lucarne("view " + moved + "/p.json " + moved + "/cornell.luc");
    EXPECT_EQ(two.code, 2) << two.output;
    std::filesystem::remove(moved + "/cornell.luc");
    const Outcome gone = lucarne("view " + moved + "/p.json --screenshot " + moved + "/p.png");
    EXPECT_EQ(gone.code, 3) << gone.output;
    EXPECT_THAT(gone.output, HasSubstr("p.json: none of its scans was found"));
}

TEST_F(WindowWithProject, ExportsThePointsThatItShows) {
    const std::string file = folder_ / "cornell-part.laz";
    start();
    const auto whole = picture(lit);
    ASSERT_TRUE(whole) << log();
    xdo("key ctrl+shift+e");
    ASSERT_TRUE(confirmed([&] { return std::filesystem::exists(file); })) << log();
    const auto all = std::filesystem::file_size(file);
    xdo("key i");  // a clip box
    ASSERT_TRUE(picture([&](const io::Image8& now) { return difference(now, *whole) > 2; })) << log();
    xdo("key ctrl+shift+e sleep 1 key Return sleep 1");
    EXPECT_EQ(std::filesystem::file_size(file), all) << "it asks before it replaces a file";
    EXPECT_TRUE(confirmed([&] { return std::filesystem::file_size(file) < all; })) << log();
    EXPECT_THAT(log(), HasSubstr("exported "));
    close();
}

TEST_F(WindowWithProject, OfAnotherWindowIsShownAndLeftAlone) {
    const Background first(screen_->environment() + " " LUCARNE_BINARY " view " + cache_ + " 2>>" +
                           (folder_ / "log"));
    ASSERT_TRUE(eventually([&] { return log().find("first picture after") != std::string::npos; })) << log();
    xdo("sleep 1 key Insert");  // a key frame, which is saved after three seconds
    ASSERT_TRUE(eventually([&] { return !project().empty(); })) << log();
    const std::filesystem::path file = project();
    start();
    ASSERT_TRUE(eventually([&] {
        return log().find("open in another window (process") != std::string::npos;
    })) << log();
    EXPECT_THAT(log(), HasSubstr("your work on this scan is shown again"));
    // Keys that come before the second window is ready are lost.
    const auto has_both_pictures = [&] {
        const std::string text = log();
        const size_t first_window = text.find("first picture after");
        return first_window != text.npos && text.find("first picture after", first_window + 1) != text.npos;
    };
    ASSERT_TRUE(eventually(has_both_pictures)) << log();
    const std::string before = bytes_of(file);
    xdo("sleep 1 key Insert sleep 5 key ctrl+shift+s");
    ASSERT_TRUE(confirmed([&] { return std::filesystem::exists(folder_ / "cornell-project.json"); }))
        << log();
    close();
    EXPECT_EQ(bytes_of(file), before) << "the first window's";
    const auto frames = [](const std::string& text) {
        size_t count = 0;
        for (size_t at = text.find("\"time\""); at != text.npos; at = text.find("\"time\"", at + 1)) ++count;
        return count;
    };
    EXPECT_EQ(frames(before), 1u);
    EXPECT_EQ(frames(bytes_of(folder_ / "cornell-project.json")), 2u);
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

class PreparingWindow : public ViewerWindow {
 protected:
    void SetUp() override {
        ViewerWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        const std::string scan = folder_ / "nave.las";
        cache_ = folder_ / "nave.luc";
        ASSERT_EQ(lucarne("generate nave --points 30k -o " + scan).code, 0);
        ASSERT_EQ(lucarne("convert " + scan + " -o " + cache_).code, 0);
        engine_ = " --mood evening --preset preview";
    }
    bool said(const std::string& what) const {
        return eventually([&] { return log().find(what) != std::string::npos; });
    }
    void close() {
        xdo("key ctrl+q");
        ASSERT_TRUE(eventually([&] {
            xdo("key ctrl+d");  // asks only if anything would be lost
            return !viewer_->running();
        })) << log();
        EXPECT_EQ(viewer_->code(), 0);
    }
};

TEST_F(PreparingWindow, PreparesARoomByAKeyWhileItsPictureIsUsedAndFindsItAgain) {
    const std::string file = cache_ + ".paths.bake";
    start();
    const auto before = picture(lit);
    ASSERT_TRUE(before) << log();
    EXPECT_FALSE(std::filesystem::exists(file)) << "nobody has asked for it";
    xdo("key alt+r sleep 0.2 key Tab");
    drag(1, 250, 300, 300, 320);
    const auto turned =
        picture([&](const io::Image8& now) { return lit(now) && difference(now, *before) > 2; });
    EXPECT_TRUE(turned) << "the picture is used meanwhile";
    ASSERT_TRUE(said("Prepared: ")) << log();
    EXPECT_THAT(log(), HasSubstr(file));
    EXPECT_TRUE(std::filesystem::exists(file));
    const auto written = std::filesystem::last_write_time(file);
    close();

    start();
    EXPECT_TRUE(picture(lit)) << log();
    xdo("key alt+r");  // does nothing
    close();
    EXPECT_EQ(std::filesystem::last_write_time(file), written) << "it is not computed again";
}

}  // namespace
}  // namespace lucarne
