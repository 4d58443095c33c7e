#pragma once

#include <filesystem>

#include "viewer/scans/file_browser.h"
#include "viewer/scans/native_dialog.h"
#include "viewer/window/kept_settings.h"
#include "viewer/window/view_model.h"
#include "viewer/window/window.h"

namespace lucarne::viewer {

/// Lets the user choose files, opens them, and remembers them in the settings. Saves scenes under the name
/// that the user gives.
class FileOpener {
 public:
    FileOpener(Window& window, ViewModel& model, KeptSettings& settings)
        : window_(window), model_(model), settings_(settings) {}

    /// Opens scans, projects and scenes (.json) that were dropped on the window or chosen in a dialog.
    void take_files();
    /// Whether a dialog in the window asks for files, so that keys are for it.
    bool asks() const { return browser_.is_open() || model_.scene_name.shown; }
    void draw() {
        draw_file_browser(browser_, model_.scan_commands);
        draw_file_question("Save scene", model_.scene_name);
    }

 private:
    void choose_files();
    void choose_folder();
    void save_scene();
    Result<void> open_scene(const std::string& file);
    void open_scenes(std::vector<std::string>& files);
    void look_at(const std::array<glm::dvec3, 2>& box);
    std::filesystem::path folder() const;

    Window& window_;
    ViewModel& model_;
    KeptSettings& settings_;
    NativeDialog dialog_, folder_dialog_;
    FileBrowser browser_;
};

}  // namespace lucarne::viewer
