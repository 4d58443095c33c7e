#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Work of the user that is in no file and ends with the window.
struct Unsaved {
    std::string what;            ///< "3 measurements"
    std::filesystem::path file;  ///< where save() puts it
    std::function<Result<void>(ViewModel& model)> save;
};

/// Which files unsaved work goes into.
enum class SaveTo {
    own_files,  ///< those it was saved to or loaded from, or named in the panels; a free name where another
                ///< has that
    free_names  ///< names that are free in the window's own folder (ViewModel::pictures)
};

/// All of it: measurements, the key frames of the flythrough, the scene. The view alone is no work.
std::vector<Unsaved> unsaved(const ViewModel& model, SaveTo to = SaveTo::own_files);
/// Saves each, also after one that failed. The first error.
Result<void> save_unsaved(ViewModel& model, SaveTo to = SaveTo::own_files);

}  // namespace lucarne::viewer
