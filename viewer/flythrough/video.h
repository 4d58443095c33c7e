#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/core/options.h"
#include "io/image/image.h"

namespace lucarne::viewer {

/// A video that ffmpeg makes of pictures, where that program is installed: it is started without a shell and
/// reads raw frames from its standard input. Which kind of video follows from the name's ending.
class VideoWriter {
 public:
    /// Before long work: whether a video can be written there. Errors: ffmpeg is not installed; the name is
    /// taken; frames of this size are none.
    static Result<void> check(const std::filesystem::path& file, bool overwrite);
    /// The program and its arguments.
    static std::vector<std::string> command(const std::filesystem::path& output, ImageSize size, double rate);

    /// `rate`: frames a second. Once `stop` is set, whatever waits for ffmpeg ends with an error.
    static Result<std::unique_ptr<VideoWriter>> start(const std::filesystem::path& file, ImageSize size,
                                                      double rate, bool overwrite,
                                                      const std::atomic<bool>& stop);
    /// Unless finish() went well, ffmpeg is ended and nothing is left of the file.
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// Errors: ffmpeg has ended, with what it said last; a picture of another size.
    Result<void> add(const io::Image8& picture);
    /// Waits until ffmpeg is done and gives the file its name.
    Result<void> finish();

 private:
    explicit VideoWriter(const std::atomic<bool>& stop) : stop_(stop) {}
    Result<void> launch(double rate);
    Result<void> wait_to_write();
    void read_words(int milliseconds);
    void remove_folder();
    tl::unexpected<Error> broken() const;

    const std::atomic<bool>& stop_;
    std::filesystem::path file_, folder_, part_;  ///< the video; where ffmpeg writes it until it is whole
    ImageSize size_;
    bool overwrite_ = false;
    int pid_ = -1, frames_ = -1, words_ = -1;  ///< process; its standard input and its error output
    std::string said_;
};

}  // namespace lucarne::viewer
