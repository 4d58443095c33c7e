#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/core/job_queue.h"
#include "octree/tree/source.h"
#include "viewer/project/lock.h"
#include "viewer/project/project.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Keeps the work on the scans of the window (viewer/project): in a file for the scan that was opened first,
/// or in the file that the user has opened or named. Shows it again when the scan or the file is opened, and
/// saves it while the user works and when the window closes. While another window has the project open, shows
/// the work and keeps nothing.
class KeptProject {
 public:
    enum class Mode {
        off,       ///< the command line says what to show
        on,        ///< shows and keeps the work
        show_only  ///< shows the work of a file that use() names, and writes nothing
    };
    KeptProject(ViewModel& model, Mode mode) : model_(model), mode_(mode) {}

    /// Declares the file whose project the next scans belong to, and those of its scans that are missing.
    void use(std::filesystem::path file, std::vector<std::string> missing);
    /// Declares which of its scans are still missing after others of them have been opened.
    void still_missing(std::vector<std::string> missing) { missing_ = std::move(missing); }
    /// Call when scans have been placed in the window for the first time: shows the work that was kept on
    /// them. Returns whether there was any; then view, light and engine are the project's.
    bool open(const octree::NodeSource& source);
    /// Call once a frame. `changed`: whether the window shows anything but what it opens with. Saves on a
    /// thread every few seconds.
    void follow(bool changed);
    /// Call when all scans have been closed. Saves, and keeps nothing from then on, because another scan may
    /// be opened next.
    void close();
    /// Saves now, and waits. Returns whether all work is kept, so that nothing would be lost.
    bool keep();
    /// Saves in a file, in which the work is kept from then on. Errors: no scan is open; another window has
    /// the file open; it exists and `overwrite` is false; it cannot be written.
    Result<void> save_as(const std::filesystem::path& file, bool overwrite);

 private:
    using Clock = std::chrono::steady_clock;
    std::string text(const std::filesystem::path& folder);
    void note_scans();
    void lock();
    void show(Project project, const octree::NodeSource& source);

    ViewModel& model_;
    Mode mode_;
    bool changed_ = false;
    bool named_ = false;          ///< the file is the user's, not the one for the first scan
    std::filesystem::path file_;  ///< empty: nothing is kept
    ProjectLock lock_;
    std::vector<std::string> missing_;
    ScanGroups scans_;   ///< open now, or before the last was closed
    std::string saved_;  ///< the text that was given to the disk last
    Clock::time_point looked_ = Clock::now();
    struct Outcome {
        std::mutex mutex;
        bool failed = false;
        std::string problem;  ///< to be shown once
    };
    std::shared_ptr<Outcome> outcome_ = std::make_shared<Outcome>();
    JobQueue writer_;
};

}  // namespace lucarne::viewer
