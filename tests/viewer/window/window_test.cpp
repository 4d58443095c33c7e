// The viewer in a real window, see window_fixture.h.
#include <fstream>

#include "tests/viewer/window/measuring_window.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

TEST_F(ViewerWindow, OrbitsAndMovesTheLightAndComesHome) {
    start();
    const auto first = picture(lit);
    ASSERT_TRUE(first) << "no picture that is not blank";
    xdo("key Tab");  // the panels would take the drags
    drag(1, 250, 300, 300, 320);
    const auto turned = picture([&](const io::Image8& now) { return difference(now, *first) > 2; });
    ASSERT_TRUE(turned) << "dragging turns nothing";
    EXPECT_TRUE(lit(*turned));
    xdo("key Home");
    ASSERT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) < 0.5; }))
        << "Home does not lead back";

    drag(1, 250, 300, 200, 290);
    const auto before = picture([&](const io::Image8& now) { return difference(now, *first) > 2; });
    ASSERT_TRUE(before);
    xdo("key l");
    const auto lamp = picture([&](const io::Image8& now) { return difference(now, *before) > 2; });
    ASSERT_TRUE(lamp) << "L does not move the light";
    xdo("keydown shift");
    drag(1, 240, 300, 280, 340);
    xdo("keyup shift");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *lamp) > 0.5; }))
        << "Shift and drag do not aim";
    xdo("key ctrl+q");
    ASSERT_TRUE(eventually([&] { return log().find("not saved: the scene") != std::string::npos; })) << log();
    xdo("key ctrl+d");
    EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
}

/// Returns the mean of the bytes of some rows.
double brightness(const io::Image8& image, uint32_t from_row, uint32_t to_row) {
    double sum = 0;
    for (size_t i = size_t{from_row} * image.width * 3; i < size_t{to_row} * image.width * 3; ++i)
        sum += image.bytes[i];
    return sum / (static_cast<double>(to_row - from_row) * image.width * 3);
}

TEST_F(ViewerWindow, SwitchesLightAndColoursByKeysAndRaisesAClipsTopByItsHandle) {
    // The camera looks straight at the clipped edge of the box.
    start(" --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json --clip-box=-1,-1,-1,7,7,2.75");
    const auto lower_half = [](const io::Image8& now) {
        return brightness(now, 0, 170) < 1 && brightness(now, 200, 360) > 20;
    };
    const auto first = picture(lower_half);
    ASSERT_TRUE(first) << "the clip does not hold";
    xdo("key Tab");  // the panels would take the drags
    xdo("key u");
    const auto unlit =
        picture([&](const io::Image8& now) { return lower_half(now) && difference(now, *first) > 2; });
    ASSERT_TRUE(unlit) << "U does not switch the light off";
    for (const char* key : {"c", "c"}) xdo(std::string("key ") + key);  // intensity, elevation
    const auto heights =
        picture([&](const io::Image8& now) { return lower_half(now) && difference(now, *unlit) > 5; });
    ASSERT_TRUE(heights) << "C does not colour";
    // The handle at the centre of the clip's top, 10.6 m away and .25 m to the right.
    drag(1, 252, 180, 252, 120);
    EXPECT_TRUE(picture([](const io::Image8& now) {
        return brightness(now, 140, 165) > 20 && brightness(now, 0, 90) < 1;
    })) << "the handle does not move the face, or more than that";
}

TEST_F(ViewerWindow, AnEndOfTheLegendIsDraggedToAnotherRangeAndADoubleClickTakesItBack) {
    start(" --colour elevation --legend");
    xdo("key Tab");  // the side bar would narrow the picture
    const auto first = picture(lit);
    ASSERT_TRUE(first);
    // The legend bar's upper end is 10 text heights (of 15 pixels) from the right and 4 from the top.
    drag(1, 330, 60, 330, 160);
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) > 2; }))
        << "the handle changes no colours";
    xdo("mousemove 330 60 click --repeat 2 --delay 100 1");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) < 0.5; }))
        << "a double-click does not take it back";
}

TEST_F(ViewerWindow, FliesWithTheKeys) {
    start();
    const auto first = picture(lit);
    ASSERT_TRUE(first);
    xdo("key f");
    EXPECT_TRUE(picture([&](const io::Image8& now) {
        if (difference(now, *first) > 2) return true;
        xdo("keydown w sleep 0.7 keyup w");  // a frame that takes longer does not see the key
        return false;
    }));
}

TEST_F(ViewerWindow, SavesItselfForScripts) {
    const std::string file = folder_ / "window.png";
    start(" --screenshot " + file + " --frames 2");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
    const auto window = io::read_png(file);
    ASSERT_TRUE(window);
    EXPECT_EQ(window->width, uint32_t{kWidth});
    EXPECT_TRUE(lit(*window));
}

TEST_F(ViewerWindow, SavesThePictureOfTheEngineThatWasAskedForNotOfTheOneThatStandsIn) {
    std::vector<io::Image8> saved;
    for (const std::string engine : {"vpl", "reference --samples 1"}) {
        engine_ = " --engine " + engine;
        const std::string file = folder_ / (engine.substr(0, 3) + ".png");
        start(" --screenshot " + file + " --frames 1");
        ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
        const auto window = io::read_png(file);
        ASSERT_TRUE(window && lit(*window)) << engine;
        saved.push_back(*window);
    }
    EXPECT_GT(difference(saved[0], saved[1]), 2) << "one path a pixel is noise";
}

TEST_F(ViewerWindow, AScanAsItIsEndsAsThePictureOfItsCache) {
    resolution_ = 0.5;  // 256 pictures take half the time
    const std::string options = " --scale 0.5 --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json";
    start(options);
    // Only completely averaged pictures agree, up to single steps of some bytes.
    const auto finished = [&] { return log().ends_with("lucarne-0001.png\n"); };
    const auto of_cache = picture([&](const io::Image8& now) { return finished() && lit(now); });
    ASSERT_TRUE(of_cache);
    viewer_.reset();
    cache_ = folder_ / "cornell.las";
    start(options);
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(cache_ + ".luc"); })) << "no cache is kept";
    EXPECT_TRUE(picture([&](const io::Image8& now) {
        return finished() && difference(now, *of_cache) < 0.05;
    })) << "the picture stays another than the cache's";
}

TEST_F(MeasuringWindow, MeasuresAKnownDistanceByClicksAndSavesItWithTheScansOwnDigits) {
    measure_a_known_distance();
}

TEST_F(ViewerWindow, OpensWithNothingTakesFilesFromTheDesktopsDialogAndOutlivesABrokenOne) {
    // A dialog that answers at once replaces the desktop's.
    const std::string dialog = folder_ / "zenity";
    std::ofstream(dialog) << "#!/bin/sh\necho " << folder_ / "broken.las"
                          << "\necho " << cache_ << "\n";
    std::filesystem::permissions(dialog, std::filesystem::perms::owner_all);
    std::ofstream(folder_ / "broken.las") << "LASF and no more";
    start_with("", "PATH=" + folder_.path().string() + ":$PATH");
    ASSERT_TRUE(eventually([&] { return xdo("search --name 'No scan open'").code == 0; }));
    xdo("key ctrl+o");
    const auto oblique = picture(lit);
    ASSERT_TRUE(oblique) << log();
    EXPECT_THAT(log(), HasSubstr("broken.las"));
    // The next window has a bookmark from above again, and the recent files.
    xdo("key 9 key 5");
    std::optional<io::Image8> before;
    const auto from_above = picture([&](const io::Image8& now) {
        const bool same = before && difference(now, *before) < 0.05;
        before = now;
        return same && difference(now, *oblique) > 2;
    });
    ASSERT_TRUE(from_above);
    xdo("key ctrl+b sleep 0.5 key ctrl+q");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
    const std::string settings = bytes_of(folder_ / "config/settings.json");
    EXPECT_THAT(settings, HasSubstr(cache_));
    start_with((folder_ / "broken.las") + " " + cache_);
    ASSERT_TRUE(picture([&](const io::Image8& now) { return lit(now) && difference(now, *from_above) > 2; }));
    EXPECT_TRUE(picture([&](const io::Image8& now) {
        xdo("key alt+1 sleep 0.5");
        return difference(now, *from_above) < 1;
    })) << "the bookmark does not lead there";
}

TEST_F(ViewerWindow, ABrokenSettingsFileIsReportedAndPutAside) {
    std::filesystem::create_directory(folder_ / "config");
    std::ofstream(folder_ / "config/settings.json") << "{ this is no JSON";
    start();
    EXPECT_THAT(log(), HasSubstr("settings.json.broken"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "config/settings.json.broken"));
    EXPECT_TRUE(picture(lit));
}

TEST_F(ViewerWindow, AFlythroughIsMadePlayedSavedAndRenderedByKeys) {
    // The replacement for ffmpeg keeps its input; the last argument is file:NAME.
    const std::string program = folder_ / "ffmpeg";
    std::ofstream(program) << "#!/bin/sh\nfor last; do :; done\nexec cat > \"${last#file:}\"\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    start_with(cache_, "PATH=" + folder_.path().string() + ":$PATH");
    const auto first = picture([&](const io::Image8& now) { return whole() && lit(now); });
    ASSERT_TRUE(first);
    xdo("key Tab");  // the panels would take the drags
    xdo("key Insert sleep 0.3");
    drag(1, 250, 200, 300, 210);
    const auto turned =
        picture([&](const io::Image8& now) { return whole() && difference(now, *first) > 2; });
    ASSERT_TRUE(turned);
    xdo("key Insert sleep 0.3");
    EXPECT_TRUE(
        picture([&](const io::Image8& now) {  // with two bookmarks, "previous" alternates between them
            if (nearer(now, *first, *turned)) return true;
            xdo("key alt+Left sleep 2");
            return false;
        }))
        << "the key frame before is not where it was set";
    xdo("key space");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *turned, *first); }))
        << "playing does not end at the last key frame";
    xdo("key alt+s");
    const std::string path = folder_ / "flythrough.json", video = folder_ / "flythrough.mp4";
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(path); }));
    const auto flown = lucarne("fly " + cache_ + " --path " + path + " --engine direct --size 16x12 -o " +
                               (folder_ / "report.json"));
    EXPECT_EQ(flown.code, 0) << flown.output;
    EXPECT_THAT(bytes_of(folder_ / "report.json"), HasSubstr("\"frames\": 51"));
    xdo("key ctrl+F11");
    ASSERT_TRUE(eventually([&] { return !viewer_->running() || std::filesystem::exists(video); }));
    EXPECT_EQ(std::filesystem::file_size(video), size_t{51} * kWidth * kHeight * 3);
    xdo("key shift+t key ctrl+F12");
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "picture.png"); }));
}

TEST(Viewer, WithoutADisplayItSaysSoInOneLine) {
    const test::TemporaryFolder folder;
    const std::string cache = make_cornell(folder, "2k");
    const Outcome outcome = shell("env -u DISPLAY -u WAYLAND_DISPLAY " LUCARNE_BINARY " view " + cache);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("lucarne: window: "));
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
}

}  // namespace
}  // namespace lucarne
