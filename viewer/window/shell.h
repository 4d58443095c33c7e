#pragma once

#include <string>
#include <vector>

#include "viewer/bookmarks/bookmarks.h"
#include "viewer/window/settings.h"

namespace lucarne::viewer {

class ScanSet;

/// The part of the ViewModel around the picture: open scans, files, and requests about the window.
struct Shell {
    ScanSet* scans = nullptr;          ///< the open scans; outlive the model
    std::vector<std::string> to_open;  ///< paths that are requested to be opened
    bool want_file = false;            ///< File > Open was chosen
    bool ask_to_close = false;         ///< the question before closing is shown
    bool save_to_close = false;        ///< the answer: save unsaved work, then close
    bool close_now = false;            ///< the answer: close without saving
    std::string closing_problem;       ///< why saving failed
    Settings settings;

    std::vector<Bookmark> bookmarks;
    bool bookmarks_changed = false;        ///< by the user; they have to be written
    std::vector<unsigned> stale_textures;  ///< textures of removed bookmarks
    size_t bookmark = 0;                   ///< the bookmark that was visited last
};

}  // namespace lucarne::viewer
