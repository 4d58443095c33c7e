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

/// Paths of scans; those of a group share one cache.
using ScanGroups = std::vector<std::vector<std::string>>;

/// The user's work on scans. The window keeps it without being asked, in a file for the scan that was opened
/// first or in a file that the user has named. data/README.md ("Projects") describes the file.
struct Project {
    ScanGroups scans;          ///< absolute paths
    gi::Scene scene;           ///< its first camera is the view, `render` how pictures are made
    std::optional<Mood> mood;  ///< whose light it is
    std::vector<Measurement> measurements;
    std::optional<CameraPath> flythrough;
};

/// Returns the file under `config` (the folder of settings) that keeps a scan's project; empty without a
/// folder.
std::filesystem::path project_file(const std::filesystem::path& config, const std::string& scan);

/// Returns the text of a project's file.
std::string project_text(const Project& project, double metres_per_unit, const std::filesystem::path& folder);

/// Returns whether a file is a project, as opposed to a scene. It may still be one that cannot be read.
bool is_project(const std::filesystem::path& file);

/// Reads a project from a text that errors call `name`. `folder` is that of its file. If `metres_per_unit` is
/// known, measurements in another unit are an error. Errors: a newer version, a wrong key.
Result<Project> parse_project(std::string_view text, const std::string& name,
                              const std::filesystem::path& folder, std::optional<double> metres_per_unit);
/// Reads a project's file, which stays as it is.
Result<Project> read_project(const std::filesystem::path& file, std::optional<double> metres_per_unit);

/// The scans of a project: those that are there, and those that are not.
struct FoundScans {
    ScanGroups found;
    std::vector<std::string> missing;
};
/// Looks for a project's scans at their paths, then under their names in `folder`.
FoundScans find_scans(const ScanGroups& scans, const std::filesystem::path& folder);
/// Returns the line about missing scans of a project's file; empty if there are none.
std::string missing_text(const std::filesystem::path& file, const std::vector<std::string>& missing);

/// What was found when a scan was opened.
struct LoadedProject {
    std::optional<Project> project;
    std::string problem;    ///< a message for the user; empty: no problem
    bool may_write = true;  ///< false: the file is a newer program's, or could not be moved aside
};
/// Reads the project that the window keeps by itself. A file that cannot be read is moved aside
/// (put_aside()); that of a newer version stays.
LoadedProject load_project(const std::filesystem::path& file, double metres_per_unit);

}  // namespace lucarne::viewer
