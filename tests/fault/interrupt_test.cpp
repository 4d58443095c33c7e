// SIGINT, SIGTERM and SIGHUP: resumable work is kept and reported; no other files are left.
#include <array>
#include <csignal>

#include <gmock/gmock.h>

#include "tests/fault/run_lucarne.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using io::testing::read_bytes;
using io::testing::write_bytes;
using test::lucarne;
using test::lucarne_with_fault;
using test::Outcome;
using test::quoted;
using ::testing::HasSubstr;

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

class Interrupt : public ::testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate two-rooms --points 5k -o " + quoted(scan_)).code, 0);
        fs::create_directory(out_);
    }
    /// Returns the number (from 1) of the last or first call of this name.
    size_t call_of(const std::string& name, bool last, const std::string& arguments,
                   const std::string& before = {}) {
        const auto calls = test::traced_calls(folder_ / "calls", arguments, before);
        const auto first = static_cast<size_t>(std::ranges::find(calls, name) - calls.begin()) + 1;
        const size_t found = last ? test::last_call(calls, name) : first % (calls.size() + 1);
        EXPECT_GT(found, 0u) << name;
        fs::remove_all(out_);
        fs::create_directory(out_);
        return found;
    }
    static Outcome interrupted(size_t call, int signal, const std::string& arguments,
                               const std::string& before = {}) {
        const auto fault = "signal:" + std::to_string(call) + ":" + std::to_string(signal);
        const auto outcome = lucarne_with_fault(fault, arguments, before);
        EXPECT_EQ(outcome.signal, signal) << outcome.text;
        return outcome;
    }
    std::vector<fs::path> left() const { return {fs::directory_iterator(out_), fs::directory_iterator()}; }

    const io::testing::TemporaryFolder folder_;
    const fs::path scan_ = folder_ / "a.las", out_ = folder_ / "out", cache_ = out_ / "a.luc";
    const std::string convert_ = "convert --normals none " + quoted(scan_) + " -o " + quoted(cache_);
};

TEST_F(Interrupt, OfAConversionKeepsItsStagesAndSaysHowToGoOn) {
    const size_t call = call_of("fsync", false, convert_);
    ASSERT_EQ(lucarne(convert_).code, 0);
    const std::string reference = read_bytes(cache_);
    fs::remove(cache_);
    for (const int signal : kSignals) {
        for (const std::string resume : {"", " --resume"}) {
            const auto outcome = interrupted(call, signal, convert_ + resume);
            ASSERT_EQ(left().size(), 1u);
            EXPECT_THAT(outcome.text, HasSubstr(left()[0].string() + ": keeps "));
            EXPECT_THAT(
                outcome.text,
                HasSubstr(resume.empty() ? "give the same command with --resume to go on after 'chunk'"
                                         : "give the same command again to go on after 'chunk'"));
            const auto resumed = lucarne(convert_ + " --resume");
            ASSERT_EQ(resumed.code, 0) << resumed.text;
            EXPECT_THAT(resumed.text, HasSubstr("going on after 'chunk'"));
            EXPECT_TRUE(read_bytes(cache_) == reference);
            fs::remove(cache_);
            EXPECT_TRUE(left().empty());
        }
    }
}

TEST_F(Interrupt, OfAConversionThatHasFinishedNoStageLeavesNothing) {
    const size_t call = call_of("pwrite", false, convert_);  // the journal's write
    for (const int signal : kSignals) {
        const auto outcome = interrupted(call, signal, convert_);
        EXPECT_TRUE(left().empty()) << outcome.text;
        EXPECT_EQ(outcome.text, "");
    }
}

TEST_F(Interrupt, ThatIsIgnoredStaysIgnored) {
    const size_t call = call_of("fsync", false, convert_);
    const auto fault = "signal:" + std::to_string(call) + ":" + std::to_string(SIGHUP);
    const auto done = lucarne_with_fault(fault, convert_, "trap '' HUP; ");
    EXPECT_EQ(done.code, 0) << done.text;
}

TEST_F(Interrupt, LeavesNoPartOfAnOutputWhereFilesNeedAName) {
    ASSERT_EQ(lucarne(convert_).code, 0);
    fs::rename(cache_, folder_ / "a.luc");
    const std::string cache = quoted(folder_ / "a.luc"), named = "LUCARNE_NO_TMPFILE=1 ";
    for (const std::string& arguments :
         {"export " + cache + " -o " + quoted(out_ / "b.las"), "compact " + cache}) {
        const size_t call = call_of("fsync", false, arguments, named);
        for (const int signal : kSignals) {
            interrupted(call, signal, arguments, named);
            EXPECT_TRUE(left().empty()) << arguments;
            EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 4) << arguments;
        }
    }
}

TEST_F(Interrupt, LeavesNoHalfReplacedOutput) {
    ASSERT_EQ(lucarne(convert_).code, 0);
    fs::rename(cache_, folder_ / "a.luc");
    const auto export_over =
        "export --overwrite " + quoted(folder_ / "a.luc") + " -o " + quoted(out_ / "b.las");
    const size_t call = call_of("linkat", false, export_over);
    write_bytes(out_ / "b.las", "old");
    for (const size_t at : {call, call + 1}) {
        interrupted(at, SIGTERM, export_over);
        EXPECT_EQ(left().size(), 1u);
        EXPECT_EQ(read_bytes(out_ / "b.las"), "old");
    }
}

TEST_F(Interrupt, LeavesNoTemporaryFolder) {
    const auto measure = "measure --no-cache --at 1,1,1 " + quoted(scan_);
    const auto there = "TMPDIR=" + quoted(out_) + " ";
    const size_t call = call_of("fsync", false, measure, there);
    for (const int signal : kSignals) {
        interrupted(call, signal, measure, there);
        EXPECT_TRUE(left().empty());
    }
}

TEST_F(Interrupt, OfAFlightLeavesWholeFramesAndNoPartOfAVideo) {
    ASSERT_EQ(lucarne("convert " + quoted(scan_) + " -o " + quoted(folder_ / "a.luc")).code, 0);
    write_bytes(
        folder_ / "path.json",
        R"({"frames_per_second": 3, "keys": [{"time": 0, "position": [1, 1, 1], "target": [2, 1, 1]},)"
        R"( {"time": 1, "position": [1.5, 1, 1], "target": [2, 1, 1]}]})");
    const auto fly = "fly " + quoted(folder_ / "a.luc") + " --engine unlit --size 64x48 --wait --path " +
                     quoted(folder_ / "path.json") + " -o " + quoted(out_ / "report.json");
    const auto frames = fly + " --frames-dir " + quoted(out_ / "frames");
    const size_t second =
        call_of("linkat", false, frames) + 2;  // a frame has been synced and named, and its folder synced
    interrupted(second, SIGINT, frames);
    ASSERT_EQ(left().size(), 1u);
    EXPECT_EQ(std::distance(fs::directory_iterator(out_ / "frames"), {}), 1);
    // A replacement for ffmpeg that writes its input.
    fs::create_directory(folder_ / "bin");
    write_bytes(folder_ / "bin" / "ffmpeg",
                "#!/bin/sh\nfor last; do :; done\nexec cat > \"${last#file:}\"\n");
    fs::permissions(folder_ / "bin" / "ffmpeg", fs::perms::owner_all);
    const auto path = "PATH=" + quoted(folder_ / "bin") + ":\"$PATH\" ";
    const auto video = fly + " --video " + quoted(out_ / "v.mp4");
    const size_t whole = call_of("rename", false, video, path);
    for (const int signal : kSignals) {
        interrupted(whole, signal, video, path);
        EXPECT_TRUE(left().empty());
    }
}

}  // namespace
}  // namespace lucarne
