// A newcomer's first half hour in a real window under a window manager.
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/io/io_testing.h"
#include "tests/viewer/window/places.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

class Newcomer : public ManagedWindow {
 protected:
    void SetUp() override {
        ManagedWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        // Replaces the desktop's dialog and the user's answer.
        const std::string dialog = folder_ / "zenity";
        std::ofstream(dialog) << "#!/bin/sh\necho " << folder_ / "cornell.las"
                              << "\n";
        std::filesystem::permissions(dialog, std::filesystem::perms::owner_all);
    }
    void open_window() {
        start_with("", "PATH=" + folder_.path().string() + ":$PATH");
        ASSERT_TRUE(title_comes("No scan open")) << "start page";
        window_ = xdo("getactivewindow").output;
        window_.pop_back();
        xdo("key ctrl+o");
        ASSERT_TRUE(eventually([&] { return xdo("search --name 'Lucarne - cornell'").code == 0; })) << log();
    }
    std::string at(int x, int y) const {
        return fmt::format("mousemove --window {} {} {} sleep 0.3 ", window_, x, y);
    }
    /// `answer`: the key that answers the question about unsaved work; empty: no question is expected.
    void close_window(const std::string& answer = "") {
        xdo("key alt+F4");
        if (!answer.empty()) {
            ASSERT_TRUE(eventually([&] { return log().find("asked whether to close") != std::string::npos; }))
                << log();
            xdo("key " + answer);
        }
        ASSERT_TRUE(eventually([&] { return !viewer_->running(); })) << "it does not close";
        EXPECT_EQ(viewer_->code(), 0);
    }
    /// Returns a complete picture that differs from another one and does not change any more. A sketch may
    /// stand still as well while other programs keep the processor busy, but what follows it differs by as
    /// much.
    std::optional<io::Image8> changed(const io::Image8& from, double by) {
        std::optional<io::Image8> before;
        return picture([&](const io::Image8& now) {
            const bool still = before && whole() && difference(now, *before) < 0.2;
            before = now;
            return still && difference(now, from) > by;
        });
    }
    std::string window_;
};

TEST_F(Newcomer, OpensLooksLightsMeasuresClipsAndFindsItAllAgain) {
    open_window();
    ASSERT_TRUE(picture(lit)) << "open\n" << log();
    EXPECT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "cornell.las.luc"); }));
    xdo("key Tab sleep 0.3 key 0");  // panels would take clicks
    std::optional<io::Image8> seen =
        changed(io::Image8{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight * 3)}, 1);
    ASSERT_TRUE(seen);

    xdo(at(250, 280) + "mousedown 1 sleep 0.3 " + at(270, 290) + at(300, 300) + "mouseup 1");
    std::optional<io::Image8> next = changed(*seen, 2);
    ASSERT_TRUE(next) << "orbit";

    xdo("key l");
    seen = changed(*next, 0.4);
    ASSERT_TRUE(seen) << "light";

    xdo("key ctrl+2");
    xdo(at(120, 200) + "click 1 sleep 0.4 " + at(280, 220) + "click 1 sleep 0.4");
    const std::string csv = folder_ / "measurements.csv";
    ASSERT_TRUE(eventually([&] {
        xdo("key ctrl+e sleep 0.3");
        return std::filesystem::exists(csv);
    })) << "measure\n"
        << log();
    const size_t length = bytes_of(csv).find("Distance 1,distance,length,");
    ASSERT_NE(length, std::string::npos) << bytes_of(csv);
    EXPECT_GT(std::stod(bytes_of(csv).substr(length + 27)), 0.1) << "metres in a box of 5.5";
    xdo("key Escape");

    xdo("key i");
    next = changed(*seen, 1);
    ASSERT_TRUE(next) << "clip";
    xdo("key alt+i");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *seen) < 2; }))
        << "and clip nothing";

    xdo("key u");  // without light, since a bookmark has only a camera
    next = changed(*seen, 1);
    ASSERT_TRUE(next) << "light off";
    xdo("key 5");
    const auto above = changed(*next, 2);
    ASSERT_TRUE(above) << "from the top";
    xdo("key ctrl+b sleep 0.5");

    xdo("key Insert sleep 0.3 key 1");
    const auto front = changed(*above, 2);
    ASSERT_TRUE(front) << "from the front";
    xdo("key Insert sleep 0.3");
    EXPECT_TRUE(
        picture([&](const io::Image8& now) {  // with two bookmarks, "previous" alternates between them
            if (nearer(now, *above, *front)) return true;
            xdo("key alt+Left sleep 2");
            return false;
        }))
        << "a flythrough's first key frame";
    xdo("key space");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return nearer(now, *front, *above); }))
        << "playing ends at the last one";
    const std::string path = folder_ / "flythrough.json";
    xdo("key alt+s");
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(path); })) << "flythrough";
    const Outcome flown = lucarne("fly " + cache_ + " --path " + path + " --engine direct --size 16x12 -o " +
                                  (folder_ / "report.json"));
    EXPECT_EQ(flown.code, 0) << flown.output;

    const std::string shot = folder_ / "picture.png";
    xdo("key ctrl+F12");
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(shot); })) << "screenshot\n" << log();
    const auto saved = io::read_png(shot);
    ASSERT_TRUE(saved && saved->width == kWidth && saved->height == kHeight);
    EXPECT_TRUE(nearer(*saved, *front, *above)) << "it shows another view";

    close_window("Return");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "scene-0001.json")) << "with the light where it was put";
    EXPECT_THAT(bytes_of(folder_ / "config/settings.json"), HasSubstr("cornell.las"));

    open_window();
    ASSERT_TRUE(changed(*above, 2)) << "reopen";
    xdo("key Tab key u");
    EXPECT_TRUE(picture([&](const io::Image8& now) {
        xdo("key alt+1 sleep 0.5");
        return difference(now, *above) < 3;
    })) << "the bookmark leads back";
    close_window();
}

/// A newcomer who has only a mouse, and a raw scan of a room.
class NewcomerWithAMouse : public ManagedWindow {
 protected:
    void SetUp() override {
        width_ = 940;  // the moods' buttons need room beside the side bar
        height_ = 600;
        engine_.clear();  // nothing says what to show
        ManagedWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        room_ = folder_ / "room.las";
    }
    void walk();
    /// Starts with the scan as the only argument, and waits for the window's first complete picture.
    std::optional<io::Image8> open() {
        start_with(room_);
        window_ = xdo("search --name 'Lucarne - '").output;
        window_ = window_.substr(0, window_.find('\n'));
        return picture(lit);
    }
    void click(const ImVec2& place) const {
        xdo(fmt::format("mousemove --window {} {} {} sleep 0.4 click 1 sleep 0.4", window_, place.x,
                        place.y));
    }
    void choose(std::string_view action) {
        const auto places = places_.action(action);
        ASSERT_TRUE(places) << action;
        for (const ImVec2& place : *places) click(place);
    }
    void quit() {
        choose("Quit");
        ASSERT_TRUE(eventually([&] { return !viewer_->running(); })) << log();
        EXPECT_EQ(viewer_->code(), 0);
    }
    /// The files of the work that was kept by itself.
    std::vector<std::filesystem::path> projects() const {
        std::vector<std::filesystem::path> found;
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / "config/projects", none))
            if (entry.path().extension() == ".json") found.push_back(entry.path());
        return found;
    }

    bool has_measurement() const {
        return !projects().empty() &&
               bytes_of(projects().front()).find("\"measurements\"") != std::string::npos;
    }

    Places places_{{940, 600}};
    std::string room_, window_;
};

void NewcomerWithAMouse::walk() {
    const auto colours = open();  // step 1
    ASSERT_TRUE(colours) << log();

    const auto evening = places_.mood(viewer::Mood::evening);
    ASSERT_TRUE(evening);
    click(*evening);  // step 2
    const auto lamps = picture([&](const io::Image8& now) { return difference(now, *colours) > 5; });
    ASSERT_TRUE(lamps) << log();

    choose("Distance");  // step 3
    // A click takes no point where another surface hides the points of all discs about it: one clicks again.
    // Where the window is slow, a menu may open after the click on its entry: one opens it again.
    int clicks = 0;
    ASSERT_TRUE(eventually([&] {
        if (has_measurement()) return true;
        if (clicks % 24 == 23) choose("Distance");
        click({static_cast<float>(450 + 190 * (clicks % 3)), static_cast<float>(420 + 8 * (clicks % 7))});
        ++clicks;
        return false;
    })) << log();
    // Where the window is slow, picture() pressed its key more than once and has left older pictures.
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
        if (entry.path().extension() == ".png") std::filesystem::remove(entry.path());
    choose("Save the picture as PNG");  // step 4
    const std::string shot = folder_ / "lucarne-0001.png";
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(shot); })) << log();
    const auto saved = io::read_png(shot);
    ASSERT_TRUE(saved);
    EXPECT_TRUE(nearer(*saved, *lamps, *colours)) << difference(*saved, *lamps) << " from the evening, "
                                                  << difference(*saved, *colours) << " from scan colours\n"
                                                  << log();

    quit();  // step 5
    EXPECT_THAT(log(), testing::Not(HasSubstr("asked whether to close"))) << "nothing would be lost";
    ASSERT_EQ(projects().size(), 1u) << log();
    const nlohmann::json kept = nlohmann::json::parse(bytes_of(projects().front()));
    EXPECT_EQ(kept.at("mood"), "evening");
    ASSERT_GE(kept.at("measurements").at("measurements").size(), 1u);

    const auto again = open();  // step 6
    ASSERT_TRUE(again) << log();
    EXPECT_THAT(log(), HasSubstr("your work on this scan is shown again"));
    EXPECT_TRUE(nearer(*again, *lamps, *colours)) << "light and view are those of the day before";
    quit();
    EXPECT_EQ(nlohmann::json::parse(bytes_of(projects().front())).at("measurements"),
              kept.at("measurements"));
}

TEST_F(NewcomerWithAMouse, SeesARoomInEveningLightMeasuresItSavesAPictureAndFindsItAllAgainInSixSteps) {
    const Outcome made = lucarne("generate nave --points 60k -o " + room_);
    ASSERT_EQ(made.code, 0) << made.output;
    walk();
}

TEST_F(NewcomerWithAMouse, DoesTheSameInARealRoom) {
    const std::filesystem::path loft = io::testing::shared_data() / "interiors/loft.laz";
    if (!std::filesystem::exists(loft)) GTEST_SKIP() << "the shared data is not here";
    room_ = folder_ / "room.laz";
    std::filesystem::copy(loft, room_);
    walk();
}

}  // namespace
}  // namespace lucarne
