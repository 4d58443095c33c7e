#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/core/options.h"
#include "io/image/image.h"

namespace lucarne::viewer {

/// Writes pictures as a video by ffmpeg, which must be installed. ffmpeg is started without a shell and reads
/// raw frames from its standard input. The file name's extension determines the video format.
class VideoWriter {
 public:
    /// Checks before long work whether the video can be written. Errors: ffmpeg is not installed; the file
    /// exists; the extension is not supported.
    static Result<void> check(const std::filesystem::path& file, bool overwrite);
    /// Returns the program and its arguments.
    static std::vector<std::string> command(const std::filesystem::path& output, ImageSize size, double rate);

    /// Starts ffmpeg. `rate`: frames a second. Once `stop` is set, functions that wait for ffmpeg return an
    /// error.
    static Result<std::unique_ptr<VideoWriter>> start(const std::filesystem::path& file, ImageSize size,
                                                      double rate, bool overwrite,
                                                      const std::atomic<bool>& stop);
    /// Unless finish() succeeded, ends ffmpeg and removes the unfinished file.
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// Adds a frame. Errors: ffmpeg has ended (with its last messages); the picture has another size.
    Result<void> add(const io::Image8& picture);
    /// Waits until ffmpeg is done and gives the file its final name.
    Result<void> finish();

 private:
    explicit VideoWriter(const std::atomic<bool>& stop) : stop_(stop) {}
    Result<void> launch(double rate);
    Result<void> wait_to_write();
    void read_words(int milliseconds);
    void remove_folder();
    tl::unexpected<Error> broken() const;

    const std::atomic<bool>& stop_;
    std::filesystem::path file_, folder_, part_;  ///< the video; its private folder and unfinished file
    ImageSize size_;
    bool overwrite_ = false;
    int pid_ = -1, frames_ = -1, words_ = -1;  ///< ffmpeg's process id, standard input and error output
    std::string said_;
};

}  // namespace lucarne::viewer
