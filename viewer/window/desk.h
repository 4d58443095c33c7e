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

/// What goes on around the picture: files are chosen and opened, settings are kept, the window is closed when
/// that is all right.
class Desk {
 public:
    Desk(Window& window, ViewModel& model, ScanSet& scans) : window_(window), model_(model), scans_(scans) {}
    ~Desk();

    /// Files that were dropped, or chosen in a dialog.
    void take_files();
    void draw();
    /// The floor under the camera, world z, once it has been looked for; for walking.
    std::optional<double> floor();
    /// Whether the window is to go; asks first where work is unsaved or still running, unless `at_once`.
    bool closing(bool at_once);
    /// Keys that were pressed while that question stands.
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
    std::filesystem::path bookmarks_of_;  ///< the folder that the bookmarks are kept in; empty: none yet
    struct Read {
        std::mutex mutex;
        std::optional<LoadedBookmarks> bookmarks;
    };
    std::shared_ptr<Read> read_ = std::make_shared<Read>();
    FloorFinder floor_;
    JobQueue writer_;
};

}  // namespace lucarne::viewer
