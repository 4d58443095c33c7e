#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucarne::viewer {

/// The question where those scans of a project are that were not found.
struct MissingScans {
    bool shown = false;
    std::filesystem::path project;
    std::vector<std::string> paths;
    bool others_open = false;  ///< the rest of the project is shown
    std::string folder;        ///< as typed
    std::string problem;       ///< why the last answer failed
    bool browses = false;      ///< asks for the folder with the desktop's dialog

    void ask(std::filesystem::path file, std::vector<std::string> missing, bool others) {
        *this = {true, std::move(file), std::move(missing), others, {}, {}, false, {}};
        folder = project.parent_path().string();
    }
    /// Returns the folder to look in, once.
    std::optional<std::string> take_answer() { return std::exchange(answer, std::nullopt); }

    std::optional<std::string> answer;
};

}  // namespace lucarne::viewer
