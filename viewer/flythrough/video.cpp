#include "viewer/flythrough/video.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <span>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/core/interrupt.h"
#include "io/core/process.h"
#include "io/files/file.h"
#include "io/files/file_io.h"
#include "io/files/private_file.h"

namespace lucarne::viewer {
namespace {

constexpr const char* kProgram = "ffmpeg";
constexpr int kLook = 100;           ///< ms between looks at `stop`
constexpr size_t kMostWords = 4096;  ///< bytes of ffmpeg's messages that are kept, the last ones

void close_fd(int& fd) {
    if (fd >= 0) close(fd);
    fd = -1;
}

}  // namespace

Result<void> VideoWriter::check(const std::filesystem::path& file, bool overwrite) {
    if (!program_installed(kProgram))
        return failed(file.string(), "ffmpeg, which makes videos, is not installed",
                      "install it, or write numbered PNG frames instead");
    // Other formats may write several files, which would remain when a flight is cancelled.
    constexpr std::array<std::string_view, 5> kEndings = {".mp4", ".mkv", ".webm", ".mov", ".avi"};
    if (std::ranges::find(kEndings, file.extension().string()) == kEndings.end())
        return bad_arguments(file.string(), "has no ending of a supported video format",
                             "name it .mp4, .mkv, .webm, .mov or .avi");
    return check_output(file, overwrite);
}

std::vector<std::string> VideoWriter::command(const std::filesystem::path& output, ImageSize size,
                                              double rate) {
    // Players need 4:2:0, which needs an even number of pixels: odd sides get one black row or column.
    return {kProgram,      "-hide_banner",
            "-loglevel",   "error",
            "-xerror",  // otherwise a full disk at the very end would pass for success
            "-f",          "rawvideo",
            "-pix_fmt",    "rgb24",
            "-video_size", fmt::format("{}x{}", size.width, size.height),
            "-framerate",  fmt::format("{}", rate),
            "-i",          "pipe:0",
            "-vf",         "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-pix_fmt",    "yuv420p",
            "-y",          "file:" + output.string()};
}

Result<std::unique_ptr<VideoWriter>> VideoWriter::start(const std::filesystem::path& file, ImageSize size,
                                                        double rate, bool overwrite,
                                                        const std::atomic<bool>& stop) {
    LUCARNE_TRY(check(file, overwrite));
    std::unique_ptr<VideoWriter> writer(new VideoWriter(stop));
    writer->file_ = file;
    // A private folder: ffmpeg would follow a link that somebody put in its output's place.
    LUCARNE_ASSIGN(writer->folder_, new_private_folder(file.has_parent_path() ? file.parent_path()
                                                                              : std::filesystem::path(".")));
    writer->part_ = writer->folder_ / file.filename();
    at_interrupt(writer->folder_, [folder = writer->folder_, part = file.filename().string()] {
        remove_private_folder(folder, std::span(&part, 1));
        return std::string();
    });
    writer->size_ = size;
    writer->overwrite_ = overwrite;
    LUCARNE_TRY(writer->launch(rate));
    return writer;
}

/// Starts ffmpeg. Frames go through a socket: writing to a program that has ended is then an error instead of
/// SIGPIPE.
Result<void> VideoWriter::launch(double rate) {
    std::array<int, 2> frames{}, words{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, frames.data()) != 0)
        return failed(kProgram, std::strerror(errno));
    if (pipe2(words.data(), O_CLOEXEC) != 0) {
        const int reason = errno;
        for (int& end : frames) close_fd(end);
        return failed(kProgram, std::strerror(reason));
    }
    frames_ = frames[0];
    words_ = words[0];
    fcntl(frames_, F_SETFL, O_NONBLOCK);
    fcntl(words_, F_SETFL, O_NONBLOCK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, frames[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, words[1], STDERR_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int failure = spawn(command(part_, size_, rate), actions, pid_);
    posix_spawn_file_actions_destroy(&actions);
    close(frames[1]);
    close(words[1]);
    if (failure == 0) return {};
    pid_ = -1;
    return failed(kProgram, fmt::format("cannot be started ({})", std::strerror(failure)));
}

VideoWriter::~VideoWriter() {
    close_fd(frames_);
    close_fd(words_);
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    remove_folder();
}

void VideoWriter::remove_folder() {
    if (folder_.empty()) return;
    const std::string part = part_.filename().string();
    remove_private_folder(folder_, std::span(&part, 1));
    forget_interrupt(folder_);
    folder_.clear();
}

tl::unexpected<Error> VideoWriter::broken() const {
    if (stop_) return failed(file_.string(), "cancelled");
    const size_t end = said_.find_last_not_of("\r\n ");
    if (end == std::string::npos) return failed(file_.string(), "ffmpeg has failed");
    const size_t line = said_.find_last_of('\n', end);
    const size_t begin = line == std::string::npos ? 0 : line + 1;
    return failed(file_.string(), "ffmpeg says: " + said_.substr(begin, end + 1 - begin));
}

/// Reads ffmpeg's messages; waits at most `milliseconds` for them.
void VideoWriter::read_words(int milliseconds) {
    pollfd there{words_, POLLIN, 0};
    if (words_ < 0 || poll(&there, 1, milliseconds) <= 0) return;
    std::array<char, 1024> buffer{};
    const ssize_t n = read(words_, buffer.data(), buffer.size());
    if (n == 0) close_fd(words_);
    if (n <= 0) return;
    said_.append(buffer.data(), static_cast<size_t>(n));
    if (said_.size() > kMostWords) said_.erase(0, said_.size() - kMostWords);
}

/// Waits until ffmpeg accepts more data. Reads its messages meanwhile; otherwise ffmpeg would block on a full
/// pipe.
Result<void> VideoWriter::wait_to_write() {
    for (;;) {
        if (stop_) return broken();
        std::array<pollfd, 2> ends{pollfd{frames_, POLLOUT, 0}, pollfd{words_, POLLIN, 0}};
        if (poll(ends.data(), ends.size(), kLook) < 0 && errno != EINTR) return broken();
        if (ends[1].revents != 0) read_words(0);
        if (ends[0].revents != 0) return {};
    }
}

Result<void> VideoWriter::add(const io::Image8& picture) {
    if (picture.width != size_.width || picture.height != size_.height)
        return failed(file_.string(), "the frames differ in size");
    for (size_t done = 0; done < picture.bytes.size();) {
        LUCARNE_TRY(wait_to_write());
        const ssize_t n =
            send(frames_, picture.bytes.data() + done, picture.bytes.size() - done, MSG_NOSIGNAL);
        if (n > 0) done += static_cast<size_t>(n);
        if (n >= 0 || errno == EAGAIN || errno == EINTR) continue;
        while (words_ >= 0 && !stop_) read_words(kLook);  // ffmpeg has ended, or is about to
        return broken();
    }
    return {};
}

Result<void> VideoWriter::finish() {
    close_fd(frames_);  // end of the frames
    int status = 0;
    for (pid_t ended = 0; ended == 0;) {
        if (stop_) return broken();
        words_ >= 0 ? read_words(kLook) : static_cast<void>(poll(nullptr, 0, kLook));
        ended = waitpid(pid_, &status, WNOHANG);
        if (ended < 0 && errno == EINTR) ended = 0;
        if (ended >= 0) continue;
        pid_ = -1;  // if SIGCHLD is ignored, the exit status is unknown
        return failed(file_.string(),
                      "ffmpeg's exit status is unknown: " + std::generic_category().message(errno));
    }
    pid_ = -1;
    for (size_t before = said_.size() + 1; words_ >= 0 && said_.size() != before;) {
        before = said_.size();
        read_words(0);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return broken();
    LUCARNE_TRY(check_output(file_, overwrite_));  // the file may have been created meanwhile
    LUCARNE_TRY(file_io::name_written(part_, file_));
    remove_folder();
    return {};
}

}  // namespace lucarne::viewer
