#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/core/error.h"
#include "io/core/options.h"
#include "io/input/six_dof.h"
#include "viewer/window/side_bar.h"

namespace lucarne::viewer {

/// What the window remembers of its user.
struct Settings {
    ImageSize window;                 ///< pixels; 0: not known yet
    std::vector<std::string> recent;  ///< paths, the newest first
    std::string navigation;           ///< "orbit", "turntable", "fly" or "walk"; empty: not chosen yet
    double text_size = 1;             ///< beside the screen's own scale
    SideBar side_bar;
    io::SixDofMapping controller;
    nlohmann::json others = nlohmann::json::object();  ///< keys that this version does not know; kept

    /// Puts a path in the front.
    void opened(const std::string& path);
};

inline constexpr size_t kMostRecent = 20;

/// Where settings, bookmarks and thumbnails are kept: $LUCARNE_CONFIG, $XDG_CONFIG_HOME/lucarne or
/// ~/.config/lucarne; empty where there is none of them.
std::filesystem::path config_folder();

/// A file that cannot be read is moved to *.broken; a sentence that says so, for people.
std::string put_aside(const std::filesystem::path& file, const Error& error);

/// What was read, and what the user has to know of it.
struct LoadedSettings {
    Settings settings;
    std::string problem;  ///< empty: none
};
/// Reads settings.json of the folder. A broken file is moved aside as settings.json.broken, and the settings
/// are as if it had not been there.
LoadedSettings load_settings(const std::filesystem::path& folder);
/// Writes it whole or not at all; makes the folder.
Result<void> save_settings(const Settings& settings, const std::filesystem::path& folder);

}  // namespace lucarne::viewer
