// Tests the program's side of the pipe with a replacement for ffmpeg.
#include "viewer/flythrough/video.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Puts this folder in front of PATH, and restores PATH at the end.
class Video : public testing::Test {
 protected:
    void SetUp() override { path_ = std::getenv("PATH"); }
    void TearDown() override { setenv("PATH", path_.c_str(), 1); }
    void install(const std::string& script) {
        const std::string program = folder_ / "ffmpeg";
        std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
        setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
    }
    auto start(const std::string& name = "out.mp4") {
        return VideoWriter::start(folder_ / name, {4, 2}, 25, false, stop_);
    }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            if (entry.path().filename() != "ffmpeg") names.push_back(entry.path().filename());
        return names;
    }
    static io::Image8 frame(uint8_t value) { return {4, 2, std::vector<uint8_t>(24, value)}; }

    test::TemporaryFolder folder_;
    std::atomic<bool> stop_{false};
    std::string path_;
};

// The last argument is file:NAME.
constexpr const char* kCopy = "for last; do :; done; exec cat > \"${last#file:}\"";

TEST_F(Video, GetsEveryByteOfEveryFrameInOrder) {
    install(kCopy);
    auto video = start("my holiday; rm -rf $HOME.mp4");
    ASSERT_TRUE(video) << video.error().line();
    std::string expected;
    for (const uint8_t value : {uint8_t{1}, uint8_t{200}, uint8_t{3}}) {
        ASSERT_TRUE((*video)->add(frame(value)));
        expected += std::string(24, static_cast<char>(value));
    }
    ASSERT_TRUE((*video)->finish());
    EXPECT_THAT(files(), ElementsAre("my holiday; rm -rf $HOME.mp4"));
    EXPECT_EQ(test::bytes_of(folder_ / files()[0]), expected);
}

TEST_F(Video, TellsFfmpegWhatItGets) {
    const auto words = VideoWriter::command("/tmp/a.mp4", {640, 361}, 29.97);
    const std::string all = testing::PrintToString(words);
    for (const char* part : {"rawvideo", "rgb24", "640x361", "29.97", "pipe:0", "file:/tmp/a.mp4"})
        EXPECT_THAT(all, HasSubstr(part));
}

TEST_F(Video, SaysSoWhereFfmpegIsNotInstalled) {
    setenv("PATH", folder_.path().c_str(), 1);
    const auto video = start();
    ASSERT_FALSE(video);
    EXPECT_THAT(video.error().line(), HasSubstr("ffmpeg, which makes videos, is not installed"));
}

TEST_F(Video, WhatFfmpegComplainsOfIsTheErrorAndNothingIsLeft) {
    install("echo 'starting' >&2; echo 'Unknown encoder' >&2; exit 1");
    auto video = start();
    ASSERT_TRUE(video);
    Result<void> done;
    for (int i = 0; i < 100'000 && done; ++i) done = (*video)->add(frame(1));
    if (done) done = (*video)->finish();
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().line(), HasSubstr("ffmpeg says: Unknown encoder"));
    video->reset();
    EXPECT_TRUE(files().empty());
}

TEST_F(Video, CancellingEndsAnFfmpegThatHangs) {
    install("exec sleep 1000");
    auto video = start();
    ASSERT_TRUE(video);
    stop_ = true;
    EXPECT_THAT((*video)->finish().error().line(), HasSubstr("cancelled"));
    video->reset();  // hangs if the program is not ended
    EXPECT_TRUE(files().empty());
}

TEST_F(Video, OverwritesNothing) {
    install(kCopy);
    std::ofstream(folder_ / "out.mp4") << "precious";
    EXPECT_THAT(start().error().line(), HasSubstr("exists already"));
    auto video = start("late.mp4");
    ASSERT_TRUE(video);
    std::ofstream(folder_ / "late.mp4") << "precious";
    EXPECT_FALSE((*video)->finish());
    EXPECT_EQ(test::bytes_of(folder_ / "late.mp4"), "precious");
    for (const char* name : {"ending", "list.m3u8", "frames.png"}) EXPECT_FALSE(start(name)) << name;
}

}  // namespace
}  // namespace lucarne::viewer
