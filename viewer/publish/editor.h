#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "viewer/flythrough/path.h"

namespace lucarne::viewer {

/// A camera path that is being edited. Its key frames are always ordered by time, and `lucarne fly` can
/// always read its file: every change goes through path_text() and parse_path(). A change that could not be
/// read back is an error and changes nothing.
class PathEditor {
 public:
    static constexpr double kStep = 2;  ///< s between the last key frame and a new one after it

    using State = std::shared_ptr<const CameraPath>;

    const CameraPath& path() const { return *now_; }  ///< has no keys at first
    bool empty() const { return path().keys.empty(); }
    /// The current path. become() restores it.
    const State& state() const { return now_; }
    void become(State state);
    std::optional<size_t> selected() const { return selected_; }
    void select(std::optional<size_t> key);

    /// Adds a key frame after the selected one, halfway to the next one, or kStep after the last. Selects it.
    Result<void> add(const gi::SceneCamera& camera);
    // These change the selected key frame. They do nothing if none is selected.
    Result<void> replace(const gi::SceneCamera& camera);  ///< the key frame's time stays
    Result<void> remove();
    Result<void> set_time(double time);  ///< s; may move the key frame before or after others
    Result<void> set_fov(double radians);
    /// Exchanges the camera with that of the key frame `by` places later. The times stay.
    Result<void> move(int by);
    Result<void> set_frames_per_second(double rate);

    /// Replaces the path by one that was kept: no change to save. Errors: it is no path.
    Result<void> restore(CameraPath path);
    /// Replaces the path by a file's. Errors: those of reading the file; on failure nothing changes.
    Result<void> load(const std::filesystem::path& file);
    /// Saves the path. Errors: there is no key frame; the file cannot be written; it exists and `overwrite`
    /// is false.
    Result<void> save(const std::filesystem::path& file, bool overwrite);
    /// Whether there are key frames that differ from those saved or loaded last.
    bool unsaved() const { return !empty() && now_ != saved_; }

 private:
    Result<void> take(CameraPath changed);
    void put(CameraPath path);

    State now_ = std::make_shared<const CameraPath>();
    State saved_ = now_;
    std::optional<size_t> selected_;
};

}  // namespace lucarne::viewer
