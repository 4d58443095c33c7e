// Scans that are opened directly: what is drawn at once, which cache is kept, and when it is found again.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "gi/device/gl/device.h"
#include "io/image/image.h"
#include "tests/viewer/program.h"
#include "tests/viewer/window/picture_difference.h"
#include "viewer/frame/pipeline.h"
#include "viewer/inputs/input.h"
#include "viewer/inputs/kept_cache.h"

namespace lucarne::viewer {
namespace {

using test::bytes_of;
using test::lucarne;
using test::Outcome;
using test::shell;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kSmall = " --engine direct --size 96x72 --overwrite ";

class RawScan : public testing::Test {
 protected:
    void SetUp() override { generate(scan_, 1); }
    void generate(const std::string& file, int seed) {
        const Outcome made = lucarne("generate cornell --points 60k --overwrite --seed " +
                                     std::to_string(seed) + " -o " + file);
        ASSERT_EQ(made.code, 0) << made.output;
    }
    Outcome render(const std::string& more) { return lucarne("render " + scan_ + kSmall + more); }
    size_t files() const {
        return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
    }

    test::TemporaryFolder folder_;
    std::string scan_ = folder_ / "a.las", picture_ = folder_ / "p.png";
};

TEST_F(RawScan, ItsCacheIsKeptBesideItAndFoundAgain) {
    const Outcome first = render("-o " + picture_);
    ASSERT_EQ(first.code, 0) << first.output;
    EXPECT_THAT(first.output, HasSubstr("a.las.luc"));
    ASSERT_TRUE(std::filesystem::exists(scan_ + ".luc"));
    const Outcome second = render("-o " + (folder_ / "q.png"));
    EXPECT_EQ(second.code, 0) << second.output;
    EXPECT_THAT(second.output, Not(HasSubstr("converting")));
    EXPECT_EQ(bytes_of(picture_), bytes_of(folder_ / "q.png"));
    const Outcome cache = lucarne("render " + scan_ + ".luc" + kSmall + "-o " + (folder_ / "r.png"));
    EXPECT_EQ(cache.code, 0) << cache.output;
    EXPECT_EQ(bytes_of(picture_), bytes_of(folder_ / "r.png"));
}

TEST_F(RawScan, ACacheOfAnotherStateOfItIsMadeAnew) {
    ASSERT_EQ(render("-o " + picture_).code, 0);
    const std::string before = bytes_of(picture_), cache = bytes_of(scan_ + ".luc");
    generate(scan_, 2);
    const Outcome again = render("-o " + picture_);
    EXPECT_EQ(again.code, 0) << again.output;
    EXPECT_THAT(again.output, HasSubstr("converting"));
    EXPECT_NE(bytes_of(scan_ + ".luc"), cache);
    EXPECT_NE(bytes_of(picture_), before);
}

TEST_F(RawScan, WhatHasItsCachesNameAndIsNoneIsLeftAlone) {
    const std::string name = scan_ + ".luc", text = "notes of mine";
    std::ofstream(name) << text;
    const Outcome outcome = shell("XDG_CACHE_HOME=" + (folder_ / "cache") + " " LUCARNE_BINARY " render " +
                                  scan_ + kSmall + "-o " + picture_);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_EQ(bytes_of(name), text);
    EXPECT_FALSE(std::filesystem::is_empty(folder_ / "cache/lucarne"));
}

TEST_F(RawScan, WithoutCacheNothingIsLeft) {
    const size_t before = files();
    const Outcome outcome = render("--no-cache -o " + picture_);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_EQ(files(), before + 1);
}

TEST_F(RawScan, TheFirstPictureConvertsNothing) {
    const size_t before = files();
    const Outcome outcome = render("--first -o " + picture_);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("first picture after"));
    EXPECT_EQ(files(), before + 1);
}

TEST_F(RawScan, TheFirstPictureShowsPointsAndNoLargeDiscs) {
    const std::string first = folder_ / "first.png", few = folder_ / "few.las",
                      render_few = "render " + few + " --engine unlit --size 480x360 ";
    ASSERT_EQ(lucarne("generate cornell --points 2000 -o " + few).code, 0);
    ASSERT_EQ(lucarne(render_few + "--first -o " + first).code, 0);
    ASSERT_EQ(lucarne(render_few + "-o " + picture_).code, 0);
    const auto dots = io::read_png(first), discs = io::read_png(picture_);
    ASSERT_TRUE(dots && discs);
    EXPECT_GT(test::difference(*dots, *discs), 5);
}

TEST_F(RawScan, OneBrokenFileAmongSeveralDoesNotStopTheFirstPicture) {
    const std::string broken = folder_ / "b.las", other = folder_ / "c.las";
    std::ofstream(broken) << bytes_of(scan_).substr(0, 300);
    generate(other, 2);
    const Outcome outcome =
        lucarne("render --first " + scan_ + " " + broken + " " + other + kSmall + "-o " + picture_);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("b.las"));
    EXPECT_THAT(outcome.output, HasSubstr("; skipped"));
    EXPECT_NE(lucarne("render --first " + broken + " " + broken + kSmall + "-o " + picture_).code, 0);
}

TEST_F(RawScan, InAFolderThatCannotBeWrittenItsCacheGoesToTheUsersOwn) {
    const std::string read_only = folder_ / "scans", cache = folder_ / "cache", out = folder_ / "out";
    for (const std::string& made : {read_only, cache, out}) std::filesystem::create_directory(made);
    std::filesystem::rename(scan_, read_only + "/a.las");
    // Nothing is read-only for root, so the program runs as nobody then.
    const bool root = geteuid() == 0;
    const std::string as = root ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
    if (root) {
        for (const std::string& given : {cache, out}) ASSERT_EQ(chown(given.c_str(), 65534, 65534), 0);
        std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
        if (shell(as + LUCARNE_BINARY " --help").code != 0)
            GTEST_SKIP() << "the program cannot be run as another user";
    }
    ASSERT_EQ(chmod(read_only.c_str(), 0555), 0);
    const std::string run = as + "env XDG_CACHE_HOME=" + cache + " " LUCARNE_BINARY " render " + read_only +
                            "/a.las" + kSmall + "-o " + out + "/p.png";
    const Outcome first = shell(run);
    EXPECT_EQ(first.code, 0) << first.output;
    EXPECT_THAT(first.output, HasSubstr(cache + "/lucarne/a.las-"));
    const Outcome second = shell(run);
    EXPECT_EQ(second.code, 0) << second.output;
    EXPECT_THAT(second.output, Not(HasSubstr("converting")));
    chmod(read_only.c_str(), 0755);
}

TEST_F(RawScan, SeveralAreOnePicture) {
    const std::string tiles = folder_ / "tiles", one = tiles + "/a.las", other = tiles + "/b.las";
    std::filesystem::create_directory(tiles);
    std::filesystem::copy(scan_, one);
    generate(other, 3);
    const std::string both = "render " + one + " " + other + kSmall + "-o " + picture_;
    const Outcome first = lucarne(both);
    EXPECT_EQ(first.code, 0) << first.output;
    const std::string together = bytes_of(picture_);
    EXPECT_THAT(lucarne(both).output, Not(HasSubstr("converting")));
    EXPECT_EQ(bytes_of(picture_), together);
    EXPECT_EQ(render("-o " + picture_).code, 0);
    EXPECT_NE(bytes_of(picture_), together);
}

TEST_F(RawScan, IsReadAsItsColumnsAndUnitAreSaid) {
    const std::string text = folder_ / "a.txt", at = " --no-cache --at 10,20,5";
    std::ofstream(text) << "20 10 5\n21 10 5\n21 11 5\n20 11 5\n";
    EXPECT_THAT(lucarne("measure " + text + at).output, HasSubstr("20 11 5"));
    EXPECT_THAT(lucarne("measure " + text + at + " --columns y,x,z").output, HasSubstr("10 20 5"));
    // Also beside a cache, which stays unchanged.
    ASSERT_EQ(render("-o " + picture_).code, 0);
    EXPECT_THAT(lucarne("measure " + scan_ + ".luc " + text + at + " --columns y,x,z").output,
                HasSubstr("10 20 5"));
    const Outcome flown =
        lucarne("fly " + text +
                " --no-cache --columns x,y --path " LUCARNE_SOURCE_DIR "/data/flythroughs/cornell.json -o " +
                (folder_ / "r.json"));
    EXPECT_NE(flown.code, 0);
    EXPECT_THAT(flown.output, HasSubstr("columns"));
}

/// Draws every source of a growing build. Returns the last picture and the number of pictures.
TEST_F(RawScan, ThePicturesOfABuildEndWithThatOfItsCache) {
    const auto device = gi::Device::headless();
    ASSERT_TRUE(device) << device.error().line();
    auto open = open_growing({{scan_}, false});
    ASSERT_TRUE(open) << open.error().line();
    ASSERT_TRUE(open->build);
    const gi::Scene scene = gi::default_scene(open->source->header().min, open->source->header().max);
    FrameRequest request;
    request.camera = scene.cameras.front();
    request.size = {96, 72};
    const auto open_pipeline = [&](std::shared_ptr<const octree::NodeSource> source) {
        auto pipeline = Pipeline::open(**device, std::move(source), {});
        EXPECT_TRUE(pipeline) << pipeline.error().line();
        EXPECT_TRUE((*pipeline)->set_engine("vpl"));
        EXPECT_TRUE((*pipeline)->set_scene(scene));
        return std::move(*pipeline);
    };
    const auto picture = [&](Pipeline& pipeline) {
        const auto stats = pipeline.render(request);
        EXPECT_TRUE(stats) << stats.error().line();
        EXPECT_EQ(stats->nodes_pending, 0u) << "half of a source is drawn";
        return pipeline.picture().download_all<uint32_t>(96 * 72);
    };
    const auto pipeline = open_pipeline(open->source);
    request.wait = true;
    const auto first = picture(*pipeline);
    request.wait = false;  // a new source is drawn completely nevertheless
    std::vector<std::shared_ptr<const octree::NodeSource>> sources;
    open->build->begin([&] { sources.push_back(open->build->state().source); });
    open->build->wait();
    ASSERT_TRUE(open->build->state().finished);
    std::vector<uint32_t> last;
    for (const auto& source : sources) {
        ASSERT_TRUE(pipeline->set_source(source));
        last = picture(*pipeline);
    }
    EXPECT_NE(last, first) << "the sample is as good as the whole";
    const auto cache = open_input(scan_ + ".luc");
    ASSERT_TRUE(cache) << cache.error().line();
    request.wait = true;
    EXPECT_EQ(last, picture(*open_pipeline(*cache)));
}

TEST(KeptCache, TwoScansOfOneNameInTwoFoldersHaveTwoPlaces) {
    const test::TemporaryFolder folder;
    io::ScanInfo a, b;
    a.path = folder / "none/a.las";
    b.path = folder / "nor/a.las";
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    const auto place_a = KeptCache({a}).place(0), place_b = KeptCache({b}).place(0);
    unsetenv("XDG_CACHE_HOME");
    ASSERT_TRUE(place_a && place_b);
    EXPECT_NE(*place_a, *place_b);
    EXPECT_EQ(place_a->parent_path(), folder.path() / "lucarne");
}

TEST(KeptCache, OfSeveralScansIsBesideTheFolderThatContainsThemAll) {
    const test::TemporaryFolder folder;
    const std::string tiles = folder / "tiles";
    std::filesystem::create_directories(tiles + "/east");
    io::ScanInfo a, b, c;
    a.path = tiles + "/a.las", b.path = tiles + "/b.las", c.path = tiles + "/east/c.las";
    const auto flat = KeptCache({a, b}).place(0), deep = KeptCache({a, b, c}).place(0);
    ASSERT_TRUE(flat && deep);
    for (const auto& place : {*flat, *deep}) {
        EXPECT_EQ(place.parent_path(), folder.path());
        EXPECT_THAT(place.filename().string(), testing::StartsWith("tiles-"));
    }
    EXPECT_NE(*flat, *deep) << "of other scans";
    EXPECT_EQ(KeptCache({b, a}).place(0)->parent_path(), folder.path());
}

TEST(KeptCache, IsNotPutOnADiskWithoutRoomForIt) {
    const test::TemporaryFolder folder;
    io::ScanInfo scan;
    scan.path = folder / "a.las";
    EXPECT_EQ(KeptCache({scan}).bytes_needed(), 0u);
    EXPECT_EQ(KeptCache({scan}).place(0), std::filesystem::path(folder / "a.las.luc"));
    scan.declared_points = 1'000'000;
    EXPECT_GT(KeptCache({scan}).bytes_needed(), 10'000'000u);
    scan.declared_points = std::numeric_limits<uint64_t>::max();
    const KeptCache endless({scan, scan, scan});
    EXPECT_GT(endless.bytes_needed(), std::numeric_limits<uint64_t>::max() / 2);
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    testing::internal::CaptureStderr();
    EXPECT_FALSE(endless.place(endless.bytes_needed()));
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("its disk has"));
    unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace lucarne::viewer
