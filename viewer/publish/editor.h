#pragma once

#include <filesystem>
#include <optional>

#include "viewer/flythrough/path.h"

namespace lucarne::viewer {

/// A camera path that is being made. Whatever is done to it, its key frames are in the order of their times,
/// and its file is one that `lucarne fly` reads: every change goes through path_text() and parse_path(), and
/// one that would not be read is an error and changes nothing.
class PathEditor {
 public:
    static constexpr double kStep = 2;  ///< s between a new key frame and the one before

    const CameraPath& path() const { return path_; }  ///< without keys at first
    bool empty() const { return path_.keys.empty(); }
    std::optional<size_t> selected() const { return selected_; }
    void select(std::optional<size_t> key);

    /// After the selected key frame, halfway to the next one, or kStep after the last; selects it.
    Result<void> add(const gi::SceneCamera& camera);
    // These change the selected key frame; without one they do nothing.
    Result<void> replace(const gi::SceneCamera& camera);  ///< its time stays
    Result<void> remove();
    Result<void> set_time(double time);  ///< s; may bring it before or after others
    Result<void> set_fov(double radians);
    /// Exchanges its camera with that of the key frame `by` places further: the times stay.
    Result<void> move(int by);
    Result<void> set_frames_per_second(double rate);
    bool can_undo() const { return !before_.empty(); }
    void undo();

    /// Takes the place of all there is. Errors: the file's; then nothing changes.
    Result<void> load(const std::filesystem::path& file);
    /// Errors: there is no key frame yet; the file cannot be written, or exists and is not to be replaced.
    Result<void> save(const std::filesystem::path& file, bool overwrite);
    /// Whether there are key frames that are other than those saved or loaded last.
    bool unsaved() const { return !empty() && revision_ != saved_; }

 private:
    struct Before {
        CameraPath path;
        uint64_t revision;
    };
    Result<void> take(CameraPath changed);
    void put(CameraPath path);

    CameraPath path_;
    uint64_t revision_ = 0, newest_ = 0, saved_ = 0;  ///< of the path; the last that was given; in the file
    std::optional<size_t> selected_;
    std::vector<Before> before_;  ///< for undo
};

}  // namespace lucarne::viewer
