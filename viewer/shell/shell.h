#pragma once

#include <string>
#include <vector>

namespace lucarne::viewer {

class ScanSet;

/// What stands around the picture: the open scans, and what the user wants done with files.
struct Shell {
    ScanSet* scans = nullptr;          ///< what is open; outlives the model
    std::vector<std::string> to_open;  ///< paths
    std::vector<std::string> recent;   ///< paths, the newest first
    bool want_file = false;            ///< File > Open
    bool show_scans = true;
};

}  // namespace lucarne::viewer
