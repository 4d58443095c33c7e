#pragma once

#include <string>
#include <vector>

#include "viewer/ui/command_queue.h"

namespace lucarne::viewer {

/// Ask the user which files to open.
struct ChooseFiles {};
/// Open files, or the scans in folders.
struct OpenFiles {
    std::vector<std::string> paths;
};
using ScanCommands = CommandQueue<ChooseFiles, OpenFiles>;

class FileBrowser;
class ScanSet;

void draw_scans_panel(ScanSet& scans);  ///< open scans, progress of loads and conversions
void draw_file_browser(FileBrowser& browser, ScanCommands& commands);

}  // namespace lucarne::viewer
