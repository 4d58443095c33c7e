#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "io/core/job_queue.h"
#include "octree/tree/source.h"
#include "viewer/project/project.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Keeps the work on the scan that the window opened first (viewer/project): shows it again when the scan is
/// opened, and saves it while the user works and when the window closes.
class KeptProject {
 public:
    /// `on`: false if the command line says what to show.
    KeptProject(ViewModel& model, bool on) : model_(model), on_(on) {}

    /// Call when scans have been placed in the window for the first time: shows the work that was kept on
    /// them. Returns whether there was any; then view, light and engine are the project's.
    bool open(std::vector<std::string> scans, const octree::NodeSource& source);
    /// Call once a frame. `changed`: whether the window shows anything but what it opens with. Saves on a
    /// thread every few seconds.
    void follow(bool changed);
    /// Call when all scans have been closed. Saves, and keeps nothing from then on, because another scan may
    /// be opened next.
    void close() { keep(), file_.clear(); }
    /// Saves now, and waits. Returns whether all work is kept, so that nothing would be lost.
    bool keep();

 private:
    using Clock = std::chrono::steady_clock;
    std::string text() const;

    ViewModel& model_;
    bool on_ = false, changed_ = false;
    std::filesystem::path file_;  ///< empty: nothing is kept
    std::vector<std::string> scans_;
    std::string saved_;  ///< the text that was given to the disk last
    Clock::time_point looked_ = Clock::now();
    struct Outcome {
        std::mutex mutex;
        bool failed = false;
    };
    std::shared_ptr<Outcome> outcome_ = std::make_shared<Outcome>();
    JobQueue writer_;
};

}  // namespace lucarne::viewer
