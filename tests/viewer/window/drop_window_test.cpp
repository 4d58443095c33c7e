// Drops files on a real window; x11/drop_files.cpp acts as the file manager.
#include <fstream>

#include <fmt/format.h>

#include "tests/viewer/window/window_fixture.h"

#ifndef LUCARNE_DROP_FILES
#define LUCARNE_DROP_FILES ""  // X11's headers are missing
#endif

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

/// Returns file:///... with all characters except letters, digits and a few marks as %XX (RFC 3986), quoted
/// for the shell.
std::string uri(const std::string& path) {
    std::string text = "file://";
    for (const char c : path) {
        const bool plain =
            std::isalnum(static_cast<unsigned char>(c)) || std::string("/-._~").find(c) != std::string::npos;
        text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return " '" + text + "'";
}

class DroppedFiles : public ManagedWindow {
 protected:
    void SetUp() override {
        if (std::string(LUCARNE_DROP_FILES).empty()) GTEST_SKIP() << "needs libx11-dev";
        ManagedWindow::SetUp();
    }
    Outcome drop(const std::string& uris) const {
        const std::string place = xdo("getactivewindow getwindowgeometry --shell").output;
        const auto value = [&](const std::string& key) {
            return std::stoi(place.substr(place.find(key) + 2));
        };
        return shell(display_ + LUCARNE_DROP_FILES +
                     fmt::format(" {} {}", value("X=") + kWidth / 2, value("Y=") + kHeight / 2) + uris);
    }
};

TEST_F(DroppedFiles, ThatAreScenesAreShown) {
    const std::string scene = folder_ / "above.json", broken = folder_ / "broken.json";
    std::ofstream(scene)
        << R"({"cameras": [{"name": "view", "position": [2.7, 2.8, 16], "target": [2.7, 2.8, 0],
                                             "up": [0, 1, 0]}],
                               "lights": [{"type": "point", "position": [2.7, 2.8, 5], "intensity": [40, 40, 40]}]})";
    std::ofstream(broken) << "{";
    start_with("");
    ASSERT_TRUE(title_comes("No scan open"));
    ASSERT_EQ(drop(uri(scene)).code, 0);
    EXPECT_TRUE(eventually([&] { return log().find("open a scan first") != std::string::npos; })) << log();
    ASSERT_EQ(drop(uri(cache_)).code, 0);
    const auto before = picture(lit);
    ASSERT_TRUE(before) << log();
    ASSERT_EQ(drop(uri(broken) + uri(scene)).code, 0);
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *before) > 2; })) << log();
    EXPECT_THAT(log(), HasSubstr("opened " + scene));
    EXPECT_THAT(log(), HasSubstr("broken.json"));
}

TEST_F(DroppedFiles, ThatAreProjectsReplaceWhatIsOpen) {
    const std::string second = folder_ / "second.las", project = folder_ / "rooms.json",
                      newer = folder_ / "newer.json", lost = folder_ / "lost.json";
    ASSERT_EQ(lucarne("generate two-rooms --points 20k -o " + second).code, 0);
    const std::string scene = R"("scene": {"cameras": [{"name": "view", "position": [2, 2, 12],
        "target": [2, 2, 0], "up": [0, 1, 0]}], "render": {"engine": "direct"},
        "lights": [{"type": "point", "position": [2, 2, 11], "intensity": [90, 90, 90]}]})";
    std::ofstream(project) << R"({"version": 1, "scans": ["/nowhere/second.las", "/nowhere/gone.las"], )"
                           << scene << "}";
    std::ofstream(newer) << R"({"version": 2, "scans": 7})";
    std::ofstream(lost) << R"({"version": 1, "scans": ["/nowhere/lost.las"], )" << scene << "}";
    start();
    const auto before = picture(lit);
    ASSERT_TRUE(before) << log();
    ASSERT_EQ(drop(uri(newer)).code, 0);
    EXPECT_TRUE(
        eventually([&] { return log().find("newer.json: version 2 is newer") != std::string::npos; }));
    ASSERT_EQ(drop(uri(lost)).code, 0);
    EXPECT_TRUE(eventually([&] {
        return log().find("lost.json: none of its scans was found") != std::string::npos;
    })) << log();
    EXPECT_TRUE(title_comes("cornell.luc")) << "what was open stays";
    ASSERT_EQ(drop(uri(project)).code, 0);
    EXPECT_TRUE(title_comes("second.las")) << log();
    // The window asks where the other one is now.
    const std::string place = folder_ / "elsewhere";
    std::filesystem::create_directory(place);
    std::filesystem::copy(second, place + "/gone.las");
    xdo("sleep 1 key ctrl+a sleep 0.3 type '" + place + "'");
    xdo("sleep 1 key Return");
    EXPECT_TRUE(title_comes("1 more")) << title() << log();
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *before) > 2; })) << log();
    EXPECT_THAT(log(), HasSubstr("rooms.json: scans not found: /nowhere/gone.las"));
    xdo("key Insert sleep 0.5");
    // Again if the key comes while something else has the keyboard.
    EXPECT_TRUE(eventually([&] {
        if (viewer_->running()) xdo("key alt+F4 sleep 2");
        return !viewer_->running();
    }));
    const std::string kept = bytes_of(project);
    for (const std::string& part : {second, place + "/gone.las", std::string("\"flythrough\"")})
        EXPECT_THAT(kept, HasSubstr(part));
    EXPECT_EQ(bytes_of(newer), R"({"version": 2, "scans": 7})");
    EXPECT_THAT(bytes_of(folder_ / "config/settings.json"), HasSubstr(project));
}

TEST_F(DroppedFiles, OpenAsScansAndTheOneThatIsNoneIsNamed) {
    const std::string greeting = folder_ / "Gr\u00fc\u00dfe, 100%.las", second = folder_ / "second.las",
                      letter = folder_ / "letter.pdf";
    std::filesystem::copy(folder_ / "cornell.las", greeting);
    ASSERT_EQ(lucarne("generate two-rooms --points 20k -o " + second).code, 0);
    std::ofstream(letter) << "%PDF-1.4\nDear reader";
    start_with("");
    ASSERT_TRUE(title_comes("No scan open"));
    const Outcome dropped = drop(uri(greeting) + uri(letter) + uri(second));
    ASSERT_EQ(dropped.code, 0) << dropped.output;
    ASSERT_TRUE(picture(lit)) << log();
    for (const std::string& scan : {greeting, second})
        EXPECT_TRUE(eventually([&] { return std::filesystem::exists(scan + ".luc"); })) << scan << "\n"
                                                                                        << log();
    EXPECT_TRUE(title_comes("Gr\u00fc\u00dfe, 100%.las and 1 more"));
    EXPECT_THAT(log(), HasSubstr(letter + ": has an unrecognised format"));

    // A second drop adds to the open scans, even if it is one file.
    ASSERT_EQ(drop(uri(cache_)).code, 0);
    EXPECT_TRUE(title_comes(" and 2 more\n")) << "all converted\n" << log();
    xdo("key alt+F4");
    EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
    const std::string settings = bytes_of(folder_ / "config/settings.json");
    for (const std::string& scan : {greeting, second, cache_}) EXPECT_THAT(settings, HasSubstr(scan));
}

}  // namespace
}  // namespace lucarne
