#pragma once

#include <filesystem>
#include <span>

#include "io/core/job_queue.h"
#include "viewer/camera/floor_finder.h"
#include "viewer/scans/file_browser.h"
#include "viewer/scans/native_dialog.h"
#include "viewer/scans/scan_set.h"
#include "viewer/window/view_model.h"
#include "viewer/window/window.h"

namespace lucarne::viewer {

/// Handles everything around the picture: choosing and opening files, keeping settings and bookmarks, and
/// closing the window.
class Desk {
 public:
    Desk(Window& window, ViewModel& model, ScanSet& scans) : window_(window), model_(model), scans_(scans) {}
    ~Desk();

    /// Opens files that were dropped on the window or chosen in a dialog.
    void take_files();
    void draw();
    /// Returns the floor under the camera for walking, world z, once it has been found.
    std::optional<double> floor();
    /// Returns whether the window may close. Unless `at_once`, asks the user first if work is unsaved or
    /// still running.
    bool closing(bool at_once);
    /// Handles keys pressed while that question is shown.
    void answer(std::span<const KeyChord> keys);

 private:
    std::string reason_to_ask() const;
    void choose_files();
    std::filesystem::path folder() const;
    void remember();
    void follow_bookmarks();

    Window& window_;
    ViewModel& model_;
    ScanSet& scans_;
    NativeDialog dialog_;
    FileBrowser browser_;
    std::filesystem::path bookmarks_of_;  ///< the folder of the bookmarks; empty: none yet
    struct Read {
        std::mutex mutex;
        std::optional<LoadedBookmarks> bookmarks;
    };
    std::shared_ptr<Read> read_ = std::make_shared<Read>();
    FloorFinder floor_;
    JobQueue writer_;
};

}  // namespace lucarne::viewer
