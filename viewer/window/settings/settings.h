#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/core/error.h"
#include "io/core/options.h"
#include "io/input/six_dof.h"
#include "viewer/ui/side_bar.h"

namespace lucarne::viewer {

/// The user's settings.
struct Settings {
    ImageSize window;                 ///< pixels; 0: not known yet
    std::vector<std::string> recent;  ///< paths, the newest first
    std::string navigation;           ///< "orbit", "turntable", "fly" or "walk"; empty: not chosen yet
    double text_size = 1;             ///< factor in addition to the screen's scale
    double device_memory = 0;         ///< cap, MiB; 0: not chosen
    SideBar side_bar;
    io::SixDofMapping controller;
    nlohmann::json others = nlohmann::json::object();  ///< unknown keys; written back

    /// Puts a path at the front of `recent`.
    void opened(const std::string& path);
};

inline constexpr size_t kMostRecent = 20;

/// Returns a path as settings keep it: absolute, without "." and "..".
std::string absolute_path(const std::string& path);

/// Returns the folder of settings, bookmarks and thumbnails: $LUCARNE_CONFIG, $XDG_CONFIG_HOME/lucarne or
/// ~/.config/lucarne. Empty if none of them is defined.
std::filesystem::path config_folder();

/// Settings that were read, and any problem.
struct LoadedSettings {
    Settings settings;
    std::string problem;  ///< message for the user; empty: no problem
};
/// Reads settings.json of the folder. A broken file is renamed to settings.json.broken, and the defaults are
/// returned.
LoadedSettings load_settings(const std::filesystem::path& folder);
/// Writes settings.json completely or not at all. Makes the folder.
Result<void> save_settings(const Settings& settings, const std::filesystem::path& folder);

}  // namespace lucarne::viewer
