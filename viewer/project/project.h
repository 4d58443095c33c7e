#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gi/scene/scene.h"
#include "viewer/flythrough/path.h"
#include "viewer/measure/measurement.h"
#include "viewer/opening/moods.h"

namespace lucarne::viewer {

/// The user's work on a scan, which the window keeps without being asked and shows again when the scan is
/// opened the next time. data/README.md ("Projects") describes the file.
struct Project {
    std::vector<std::string> scans;  ///< absolute paths, for people; the first names the project
    gi::Scene scene;                 ///< its first camera is the view, `render` how pictures are made
    std::optional<Mood> mood;        ///< whose light it is
    std::vector<Measurement> measurements;
    std::optional<CameraPath> flythrough;
};

/// Returns the file under `config` (the folder of settings) that keeps a scan's project; empty without a
/// folder.
std::filesystem::path project_file(const std::filesystem::path& config, const std::string& scan);

/// Returns the text of a project's file.
std::string project_text(const Project& project, double metres_per_unit, const std::filesystem::path& folder);

/// What was found when a scan was opened.
struct LoadedProject {
    std::optional<Project> project;
    std::string problem;    ///< a message for the user; empty: no problem
    bool may_write = true;  ///< false: the file is a newer program's, or could not be moved aside
};
/// Reads a project. A file that cannot be read is moved aside (put_aside()); that of a newer version stays.
LoadedProject load_project(const std::filesystem::path& file, double metres_per_unit);

}  // namespace lucarne::viewer
