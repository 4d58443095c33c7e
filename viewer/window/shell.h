#pragma once

#include <string>
#include <vector>

#include "viewer/bookmarks/bookmarks.h"
#include "viewer/window/settings.h"

namespace lucarne::viewer {

class ScanSet;

/// What stands around the picture: the open scans, and what the user wants done with files and the window.
struct Shell {
    ScanSet* scans = nullptr;          ///< what is open; outlives the model
    std::vector<std::string> to_open;  ///< paths
    bool want_file = false;            ///< File > Open
    bool ask_to_close = false;         ///< the question is on the screen
    bool save_to_close = false;        ///< answered: save what is unsaved, then close
    bool close_now = false;            ///< answered: close as it is
    std::string closing_problem;       ///< why saving has failed
    Settings settings;

    std::vector<Bookmark> bookmarks;
    bool bookmarks_changed = false;        ///< by the user; they are to be written
    std::vector<unsigned> stale_textures;  ///< of bookmarks that are gone
    size_t bookmark = 0;                   ///< the last that was gone to
};

}  // namespace lucarne::viewer
