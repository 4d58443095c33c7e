#pragma once

#include <array>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "viewer/ui/command_queue.h"

namespace lucarne::viewer {

/// Ask the user which files to open.
struct ChooseFiles {};
/// Open files, or the scans in folders.
struct OpenFiles {
    std::vector<std::string> paths;
};
/// Show all of one scan.
struct LookAtScan {
    std::array<glm::dvec3, 2> box;  ///< world units
};
using ScanCommands = CommandQueue<ChooseFiles, OpenFiles, LookAtScan>;

class FileBrowser;
class ScanSet;

/// Draws the open scans with the progress of loads and conversions. A double-click on a name shows that scan.
void draw_scans_panel(ScanSet& scans, ScanCommands& commands);
void draw_file_browser(FileBrowser& browser, ScanCommands& commands);

}  // namespace lucarne::viewer
