// Tests what surrounds the picture, without a window: settings, bookmarks, dialogs, open scans.
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "octree/convert/chunks/workspace.h"
#include "tests/viewer/program.h"
#include "viewer/bookmarks/bookmarks.h"
#include "viewer/camera/floor_finder.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/scans/file_browser.h"
#include "viewer/scans/native_dialog.h"
#include "viewer/scans/scan_set.h"
#include "viewer/ui/side_bar.h"
#include "viewer/window/settings/settings.h"

namespace lucarne::viewer {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

void write(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

TEST(Settings, AreReadAsTheyWereWrittenAndKeepKeysOfOtherVersions) {
    const TemporaryFolder folder;
    write(folder / "settings.json", R"({"text_size": 1.5, "of_tomorrow": {"a": [1, 2]}})");
    LoadedSettings loaded = load_settings(folder.path());
    EXPECT_EQ(loaded.problem, "");
    EXPECT_EQ(loaded.settings.text_size, 1.5);
    loaded.settings.window = {800, 600};
    loaded.settings.navigation = "walk";
    loaded.settings.device_memory = 4096;
    loaded.settings.side_bar.shown = false;
    loaded.settings.side_bar.width = 31.5;
    loaded.settings.side_bar.open.fill(false);
    loaded.settings.side_bar.unfold(BarSection::statistics);
    loaded.settings.controller.sensitivity = 2.5;
    loaded.settings.controller.from[1] = 2;
    loaded.settings.controller.scale[5] = -0.5;
    loaded.settings.opened("/a.las");
    loaded.settings.opened("/b \xff.las");  // invalid UTF-8
    loaded.settings.opened("/a.las");
    ASSERT_TRUE(save_settings(loaded.settings, folder.path()));
    const LoadedSettings again = load_settings(folder.path());
    EXPECT_EQ(again.problem, "");
    EXPECT_EQ(again.settings.window.width, 800u);
    EXPECT_EQ(again.settings.navigation, "walk");
    EXPECT_EQ(again.settings.device_memory, 4096);
    EXPECT_FALSE(again.settings.side_bar.shown);
    EXPECT_EQ(again.settings.side_bar.width, 31.5);
    EXPECT_EQ(again.settings.side_bar.open, loaded.settings.side_bar.open);
    EXPECT_EQ(again.settings.controller, loaded.settings.controller);
    ASSERT_EQ(again.settings.recent.size(), 2u);
    EXPECT_EQ(again.settings.recent.front(), "/a.las");
    EXPECT_EQ(again.settings.others["of_tomorrow"]["a"][1], 2);
}

TEST(Settings, ABrokenFileIsPutAsideAndReported) {
    for (const std::string text :
         {"{", "[]", R"({"text_size": "large"})", R"({"recent": [1]})", R"({"device_memory": -1})",
          R"({"side_bar": {"width": 1e9}})", R"({"side_bar": {"open": "light"}})",
          R"({"side_bar": {"open": [1]}})", R"({"controller": {"up": {"from": "left"}}})",
          R"({"window": {"width": 0}})"}) {
        const TemporaryFolder folder;
        write(folder / "settings.json", text);
        const LoadedSettings loaded = load_settings(folder.path());
        EXPECT_THAT(loaded.problem, HasSubstr("settings.json.broken")) << text;
        EXPECT_EQ(loaded.settings.text_size, 1) << text;
        EXPECT_EQ(test::bytes_of(folder / "settings.json.broken"), text);
        EXPECT_FALSE(std::filesystem::exists(folder / "settings.json"));
        EXPECT_EQ(load_settings(folder.path()).problem, "") << "it is reported once";
    }
}

TEST(Settings, RecentFilesAreBounded) {
    Settings settings;
    for (int i = 0; i < 100; ++i) settings.opened(fmt::format("/{}", i));
    EXPECT_EQ(settings.recent.size(), kMostRecent);
    EXPECT_EQ(settings.recent.front(), "/99");
}

TEST(Settings, AWiderSideBarOfEarlierVersionsIsNarrowed) {
    const TemporaryFolder folder;
    write(folder / "settings.json", R"({"side_bar": {"width": 80}})");
    const LoadedSettings loaded = load_settings(folder.path());
    EXPECT_EQ(loaded.problem, "");
    EXPECT_EQ(loaded.settings.side_bar.width, SideBar::kMost);
}

TEST(Settings, SectionsOfOtherVersionsAreLeftOut) {
    const TemporaryFolder folder;
    write(folder / "settings.json", R"({"side_bar": {"open": ["light", "of tomorrow"]}})");
    const LoadedSettings loaded = load_settings(folder.path());
    EXPECT_EQ(loaded.problem, "");
    for (size_t i = 0; i < kSections; ++i)
        EXPECT_EQ(loaded.settings.side_bar.open[i], kSectionNames[i] == "light") << kSectionNames[i];
}

TEST(SideBar, AKeyClosesASectionThatIsSeenAndShowsOneThatIsNot) {
    SideBar bar;
    bar.open.fill(false);
    bar.toggle(BarSection::light);
    EXPECT_TRUE(bar.shows(BarSection::light));
    EXPECT_EQ(bar.sought, BarSection::light) << "it may be scrolled away";
    bar.toggle(BarSection::light);
    EXPECT_FALSE(bar.is_open(BarSection::light));
    EXPECT_TRUE(bar.shown) << "the others stay";
    bar.shown = false;
    bar.unfold(BarSection::measure);
    EXPECT_FALSE(bar.shows(BarSection::measure)) << "a bar put away stays away when a tool opens its section";
    bar.toggle(BarSection::measure);
    EXPECT_TRUE(bar.shows(BarSection::measure)) << "the user asked for it";
}

TEST(SideBar, LeavesThePictureTwoFifthsOfTheWindow) {
    SideBar bar;
    bar.width = 30;
    EXPECT_EQ(bar.pixels(13, 1280), 390);
    EXPECT_EQ(bar.pixels(13, 500), 300);
    bar.width = 1e6;
    EXPECT_EQ(bar.pixels(10, 1e6), 10 * SideBar::kMost);
    bar.shown = false;
    EXPECT_EQ(bar.pixels(13, 1280), 0);
}

Bookmark bookmark(const std::string& name, double height) {
    Bookmark made;
    made.camera.name = name;
    made.camera.position = {1, 2, 3};
    made.camera.target = {4, 5.25, 6};
    made.camera.vertical_fov = 0.9;
    made.camera.orthographic_height = height;
    made.thumbnail = {4, 2, std::vector<uint8_t>(24, 77)};
    return made;
}

TEST(Bookmarks, ComeBackWithTheirThumbnailsAndAreASceneFile) {
    const TemporaryFolder folder;
    const auto place = bookmark_folder(folder.path(), "/scans/a.las");
    EXPECT_NE(place, bookmark_folder(folder.path(), "/scans/b.las"));
    EXPECT_TRUE(load_bookmarks(place).bookmarks.empty());
    ASSERT_TRUE(save_bookmarks({bookmark("Door", 0), bookmark("Plan \"1\"", 12.5)}, place));
    const LoadedBookmarks loaded = load_bookmarks(place);
    EXPECT_EQ(loaded.problem, "");
    ASSERT_EQ(loaded.bookmarks.size(), 2u);
    EXPECT_EQ(loaded.bookmarks[1].camera.name, "Plan \"1\"");
    EXPECT_EQ(loaded.bookmarks[1].camera.target, glm::dvec3(4, 5.25, 6));
    EXPECT_NEAR(loaded.bookmarks[1].camera.vertical_fov, 0.9, 1e-12);
    EXPECT_EQ(loaded.bookmarks[1].camera.orthographic_height, 12.5);
    EXPECT_EQ(loaded.bookmarks[0].thumbnail.bytes, std::vector<uint8_t>(24, 77));
    EXPECT_TRUE(gi::load_scene(place / "bookmarks.json"));
    write(place / "bookmarks.json", "{\"cameras\": 3}");
    EXPECT_THAT(load_bookmarks(place).problem, HasSubstr(".broken"));
}

TEST(Bookmarks, AThumbnailIsThePictureMadeSmall) {
    Picture picture;
    picture.size = {320, 144};
    picture.rgba.resize(size_t{320} * 144 * 4);
    for (size_t i = 0; i < picture.rgba.size(); ++i)  // left half red, right half blue
        picture.rgba[i] = std::byte((i / 4 % 320 < 160 ? i % 4 == 0 : i % 4 == 2) ? 200 : 0);
    const io::Image8 small = thumbnail_of(picture);
    EXPECT_EQ(small.height, 72u);
    EXPECT_EQ(small.width, 160u);
    EXPECT_THAT(std::vector<uint8_t>(small.bytes.begin(), small.bytes.begin() + 3), ElementsAre(200, 0, 0));
    EXPECT_THAT(std::vector<uint8_t>(small.bytes.end() - 3, small.bytes.end()), ElementsAre(0, 0, 200));
}

std::vector<std::string> answer(NativeDialog& dialog) {
    std::optional<std::vector<std::string>> chosen;
    return test::eventually([&] { return (chosen = dialog.poll()).has_value(); })
               ? *chosen
               : std::vector<std::string>{"it never ends"};
}

TEST(NativeDialog, GivesTheLinesThatItsProgramPrints) {
    NativeDialog dialog;
    EXPECT_FALSE(dialog.poll());
    ASSERT_TRUE(dialog.start({"printf", "%s\\n%s\\n", "/a; rm -rf b.las", "/c $(d).las"}));
    EXPECT_THAT(answer(dialog), ElementsAre("/a; rm -rf b.las", "/c $(d).las"));
    EXPECT_FALSE(dialog.open());
    ASSERT_TRUE(dialog.start({"false"})) << "cancelled";
    EXPECT_THAT(answer(dialog), ElementsAre());
    EXPECT_FALSE(dialog.start({"/there/is/no/such/program"}));
}

TEST(NativeDialog, AsksForAFolderWhereScansAre) {
    EXPECT_THAT(NativeDialog::folder_command("zenity", "/a b"),
                testing::AllOf(testing::Contains("--directory"), testing::Contains("--filename=/a b/")));
    EXPECT_THAT(NativeDialog::folder_command("kdialog", "/a b"),
                testing::AllOf(testing::Contains("--getexistingdirectory"), testing::Contains("/a b")));
}

TEST(NativeDialog, EndsItsProgramWithItself) {
    NativeDialog dialog;
    ASSERT_TRUE(dialog.start({"sleep", "1000"}));
    EXPECT_FALSE(dialog.poll()) << "the window goes on";
}

TEST(FileBrowser, ListsFoldersFirstThenScansAndHidesTheRest) {
    const TemporaryFolder folder;
    for (const char* name : {"b.LAS", "a.luc", "note.doc", ".hidden.las"}) write(folder / name, "12345");
    std::filesystem::create_directory(folder / "z");
    const FolderListing listing = list_folder(folder.path(), false);
    std::vector<std::string> names;
    for (const FolderEntry& entry : listing.entries) names.push_back(entry.name);
    EXPECT_THAT(names, ElementsAre("z", "a.luc", "b.LAS"));
    EXPECT_EQ(listing.entries[1].bytes, 5u);
    EXPECT_EQ(list_folder(folder.path(), true).entries.size(), 4u);
    EXPECT_NE(list_folder(folder / "missing", false).problem, "");
    FileBrowser browser;
    browser.open(folder / "z");
    browser.go(browser.folder().parent_path());
    browser.toggle("a.luc");
    EXPECT_THAT(browser.chosen(), ElementsAre(folder / "a.luc"));
}

TEST(FileBrowser, TakesTypedPaths) {
    const TemporaryFolder folder;
    write(folder / "a.luc", "12345");
    std::filesystem::create_directory(folder / "z");
    FileBrowser browser;
    browser.open(folder.path());
    EXPECT_EQ(browser.enter("a.luc"), folder / "a.luc");
    EXPECT_EQ(browser.enter("z"), std::nullopt);
    EXPECT_EQ(browser.folder(), folder / "z");
    EXPECT_EQ(browser.enter(folder / "a.luc"), folder / "a.luc");
    EXPECT_EQ(browser.enter("nothing"), std::nullopt);
    EXPECT_NE(browser.problem().find("nothing"), std::string::npos);
    EXPECT_EQ(browser.folder(), folder / "z") << "stays";
    EXPECT_EQ(browser.enter(".."), std::nullopt);
    EXPECT_EQ(browser.problem(), "");
    EXPECT_EQ(browser.folder(), folder.path());
    ASSERT_NE(std::getenv("HOME"), nullptr);
    EXPECT_EQ(browser.enter("~"), std::nullopt);
    EXPECT_EQ(browser.folder(), std::filesystem::path(std::getenv("HOME")));
}

/// A set of scans, with functions that wait for it.
class OpenScans : public testing::Test {
 protected:
    OpenScans()
        : set_(
              {},
              [](const octree::NodeSource& source) -> Result<StartingView> {
                  StartingView start;
                  start.box = {source.header().min, source.header().max};
                  return start;
              },
              [] {}) {}
    template <class Condition>
    bool eventually(const Condition& there) {
        return test::eventually(
            [&] {
                set_.update();
                return there();
            },
            std::chrono::milliseconds(10));
    }
    bool settles() {
        return eventually([&] {
            set_.convert_next();
            return set_.settled();
        });
    }

    TemporaryFolder folder_;
    ScanSet set_;
};

TEST_F(OpenScans, AreDrawnTogetherHiddenAndClosedAndABrokenOneStopsOnlyItself) {
    const std::string a = test::make_cornell(folder_, "20k");
    ASSERT_EQ(test::lucarne("generate nave --points 5k -o " + (folder_ / "b.las")).code, 0);
    write(folder_ / "broken.las", "LASF and nothing more");
    set_.open({a, folder_ / "b.las", folder_ / "broken.las"});
    ASSERT_EQ(set_.rows().size(), 3u);
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.rows()[0].state, ScanState::whole);
    EXPECT_EQ(set_.rows()[1].state, ScanState::whole) << "it was converted";
    EXPECT_EQ(set_.rows()[2].state, ScanState::failed);
    ASSERT_TRUE(set_.rows()[2].error);
    EXPECT_EQ(set_.error().error().kind, ErrorKind::input_rejected);
    const uint64_t points = set_.rows()[0].points, more = set_.rows()[1].points;
    EXPECT_GT(points, 15000u);
    EXPECT_EQ(set_.source()->header().points, points + more);
    ASSERT_TRUE(set_.start());

    set_.set_visible(set_.rows()[1].id, false);
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.source()->header().points, points);
    set_.set_visible(set_.rows()[1].id, true);
    set_.remove(set_.rows()[0].id);
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.source()->header().points, more);
    while (!set_.rows().empty()) set_.remove(set_.rows().front().id);
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.source(), nullptr);
}

// Slow light of the sketch would be begun otherwise, and shown when the whole scan is long there.
TEST_F(OpenScans, GrowUntilTheSourceThatHasAllPointsIsThere) {
    const std::string scan = folder_ / "a.las";
    ASSERT_EQ(test::lucarne("generate cornell --points 20k -o " + scan).code, 0);
    set_.open({scan});
    std::shared_ptr<const octree::NodeSource> sketch;
    int whole_before_its_source = 0;
    ASSERT_TRUE(eventually([&] {
        set_.convert_next();
        set_.seen();
        const bool whole = set_.rows()[0].state == ScanState::whole;
        if (!whole) sketch = set_.source();
        if (whole && sketch && set_.source() == sketch && !set_.settled()) {
            ++whole_before_its_source;
            EXPECT_TRUE(set_.grows());
        }
        return set_.settled();
    }));
    EXPECT_FALSE(set_.grows());
    if (whole_before_its_source == 0) GTEST_SKIP() << "the source was there before the scan was whole";
}

TEST_F(OpenScans, AFileThatIsOpenedAgainSaysAgainWhatIsWrongWithIt) {
    const std::string odd = folder_ / "odd.las", broken = folder_ / "broken.las";
    ASSERT_EQ(test::lucarne("generate cornell --points 5k -o " + odd).code, 0);
    std::fstream(odd, std::ios::in | std::ios::out | std::ios::binary).seekp(100).put('\x63');  // 99 records
    write(broken, "LASF and nothing more");
    testing::internal::CaptureStderr();
    for (int opened = 0; opened < 2; ++opened) {
        set_.open({odd, broken});
        EXPECT_TRUE(settles());
        while (!set_.rows().empty()) set_.remove(set_.rows().front().id);
        EXPECT_TRUE(settles());
    }
    const std::string said = testing::internal::GetCapturedStderr();
    const auto times = [&](const std::string& part) {
        int found = 0;
        for (size_t at = said.find(part); at != said.npos; at = said.find(part, at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(times(odd + ": 99 "), 2) << "once an opening, with its conversion\n" << said;
    EXPECT_EQ(times(broken + ": "), 2) << said;
}

TEST_F(OpenScans, AFolderIsTheScansInIt) {
    ASSERT_EQ(test::lucarne("generate cornell --points 5k -o " + (folder_ / "scans.las")).code, 0);
    std::filesystem::create_directories(folder_ / "all/deep");
    std::filesystem::copy(folder_ / "scans.las", folder_ / "all/1.las");
    std::filesystem::copy(folder_ / "scans.las", folder_ / "all/deep/2.las");
    set_.open({folder_ / "all"});
    ASSERT_TRUE(settles());
    ASSERT_EQ(set_.rows().size(), 2u);
    EXPECT_EQ(set_.rows()[0].name(), "1.las");
    set_.open({folder_ / "empty"});
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.rows()[2].state, ScanState::failed);
}

TEST_F(OpenScans, AScanThatAnotherWindowConvertsIsShownFromThatCacheOnceItIsFinished) {
    const std::string scan = folder_ / "a.las";
    ASSERT_EQ(test::lucarne("generate cornell --points 20k -o " + scan).code, 0);
    set_.open({scan});
    ASSERT_TRUE(eventually([&] { return set_.source() != nullptr; }));
    set_.stop(set_.rows()[0].id);
    ASSERT_TRUE(settles());
    ASSERT_EQ(set_.rows()[0].state, ScanState::stopped);
    ASSERT_FALSE(std::filesystem::exists(scan + ".luc"));

    ScanSet other(
        {}, [](const octree::NodeSource&) -> Result<StartingView> { return StartingView{}; }, [] {});
    other.open({scan});
    ASSERT_TRUE(test::eventually([&] {
        other.update();
        other.convert_next();
        return other.settled();
    }));
    ASSERT_EQ(other.rows()[0].state, ScanState::whole);
    ASSERT_TRUE(eventually([&] { return set_.rows()[0].state == ScanState::whole; }));
    ASSERT_TRUE(settles());
    EXPECT_EQ(set_.source()->header().points, other.source()->header().points);
}

TEST_F(OpenScans, AScanThatAnotherProgramConvertsIsConvertedHereIfThatOneEndsWithoutACache) {
    const std::string scan = folder_ / "a.las";
    ASSERT_EQ(test::lucarne("generate cornell --points 20k -o " + scan).code, 0);
    auto other = octree::Workspace::open(folder_.path(), scan + ".luc", "a build", octree::Resume::later, {});
    ASSERT_TRUE(other);
    set_.open({scan});
    ASSERT_TRUE(eventually([&] { return set_.source() != nullptr; }));
    set_.convert_next();
    ASSERT_TRUE(eventually([&] { return set_.rows()[0].state == ScanState::elsewhere; }));
    EXPECT_FALSE(set_.rows()[0].error) << "it is no failure";
    EXPECT_FALSE(set_.settled()) << "a better picture is to come";
    other = tl::make_unexpected(Error{});  // ends
    ASSERT_TRUE(eventually([&] {
        set_.convert_next();
        return set_.rows()[0].state == ScanState::whole;
    }));
}

TEST_F(OpenScans, AConversionThatIsStoppedLeavesThePictureAndGoesOnLater) {
    const std::string scan = folder_ / "a.las";
    ASSERT_EQ(test::lucarne("generate nave --points 300k -o " + scan).code, 0);
    set_.open({scan});
    ASSERT_TRUE(eventually([&] { return set_.source() != nullptr; }));
    const uint64_t id = set_.rows()[0].id;
    set_.convert_next();
    EXPECT_TRUE(set_.converting());
    ASSERT_TRUE(eventually([&] {  // the conversion is beyond sorting
        const ScanRow& row = set_.rows()[0];
        return row.stage == "normals" || row.stage == "building" || !row.busy();
    }));
    set_.stop(id);
    ASSERT_TRUE(settles());
    if (set_.rows()[0].state == ScanState::whole) GTEST_SKIP() << "it was done before it could be stopped";
    EXPECT_EQ(set_.rows()[0].state, ScanState::stopped);
    EXPECT_FALSE(set_.rows()[0].error) << "what the user asked for is no failure";
    EXPECT_TRUE(set_.source()->load(set_.source()->roots().front())) << "what was seen is seen";
    const auto left = [&] {
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            if (entry.path().extension() == ".lucarne-work") return true;
        return false;
    };
    EXPECT_TRUE(left());
    testing::internal::CaptureStderr();
    set_.go_on(id);
    const bool settled = settles();
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("going on after"));
    ASSERT_TRUE(settled);
    EXPECT_EQ(set_.rows()[0].state, ScanState::whole);
    EXPECT_FALSE(left());
    EXPECT_EQ(test::lucarne("verify " + scan + ".luc").code, 0);
}

TEST(Floor, IsTheFloorUnderTheEyeAndNotTheCeilingAbove) {
    const TemporaryFolder folder;
    const auto source = open_input(test::make_cornell(folder, "200k"));
    ASSERT_TRUE(source) << source.error().line();
    const auto& header = (*source)->header();
    const glm::dvec3 size = header.max - header.min;
    // Near the front, where there is no box.
    const glm::dvec3 eye(header.min.x + 0.5 * size.x, header.min.y + 0.1 * size.y,
                         header.min.z + 0.5 * size.z);
    const auto floor = floor_below(**source, eye, 1.65);
    ASSERT_TRUE(floor);
    EXPECT_NEAR(*floor, header.min.z, 0.05);
    EXPECT_FALSE(floor_below(**source, eye - glm::dvec3(0, 0, 2 * size.z), 1.65))
        << "nothing is below the floor";
    EXPECT_FALSE(floor_below(**source, eye + glm::dvec3(9 * size.x, 0, 0), 1.65));
}

}  // namespace
}  // namespace lucarne::viewer
