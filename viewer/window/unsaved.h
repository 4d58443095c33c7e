#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Unsaved work of the user, which would be lost with the window.
struct Unsaved {
    std::string what;            ///< "3 measurements"
    std::filesystem::path file;  ///< the file that save() writes
    std::function<Result<void>(ViewModel& model)> save;
};

/// The files that unsaved work is saved to.
enum class SaveTo {
    own_files,  ///< the files it was saved to or loaded from, or that the panels name; a free name if another
                ///< file has that name
    free_names  ///< free names in the folder View::pictures
};

/// Returns all unsaved work: measurements, key frames of the flythrough, the scene. A changed view does not
/// count.
std::vector<Unsaved> unsaved(const ViewModel& model, SaveTo to = SaveTo::own_files);
/// Returns what closing the window would lose: nothing if the project keeps it all.
std::vector<Unsaved> work_to_lose(const ViewModel& model);
/// Saves all unsaved work, and continues after failures. Returns the first error.
Result<void> save_unsaved(ViewModel& model, SaveTo to = SaveTo::own_files);

}  // namespace lucarne::viewer
