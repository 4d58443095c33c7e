#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// The file of the window's scene, and the scene as it was last saved or opened.
class SceneFile {
 public:
    /// Sets the file that save() overwrites.
    void set_path(std::filesystem::path path) { path_ = std::move(path); }
    const std::filesystem::path& path() const { return path_; }  ///< empty: none yet

    /// Declares the view's current scene saved.
    void mark(const View& view);
    /// Whether the scene has unsaved changes. False if all changes were undone.
    bool differs(const View& view) const;

    /// Shows the scene of a file, which becomes path(). Errors: those of gi::load_scene(); then nothing
    /// changes.
    Result<void> open(View& view, const std::filesystem::path& path);

    /// Returns the file for saving the scene: path(), or a free name in the folder of pictures.
    std::filesystem::path place(const View& view) const;
    /// Saves the scene to `path`, which becomes path(). Overwrites no other file than path(), unless told to.
    Result<void> save_as(const View& view, const std::filesystem::path& path, bool overwrite = false);
    /// Saves the scene to place() and reports that in the view's message.
    void save(View& view);

 private:
    std::filesystem::path path_;
    std::string saved_;
    uint64_t version_ = 1;
};

/// Shows a scene in the window: its light and look, the view of its first camera, and pictures made as it
/// says, as far as this program knows how. A camera named "view" is the window's own and is taken out of the
/// scene.
void show_scene(View& view, gi::Scene scene);

/// Returns the scene as the window shows it. The window's view is its first camera, named "view".
gi::Scene scene_to_save(const View& view);

}  // namespace lucarne::viewer
