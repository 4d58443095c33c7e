#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace lucarne::viewer {

/// A question for the name of a file to be written. An existing file is replaced only after the user has said
/// so.
struct FileQuestion {
    struct Answer {
        std::filesystem::path file;
        bool overwrite = false;
    };
    bool shown = false;
    std::string file;     ///< as typed
    std::string problem;  ///< why the last answer failed

    void ask() {
        shown = true;
        replaces = false;
        problem.clear();
    }
    /// Takes the name as the answer; of an existing file only when called again for the same name.
    void confirm();
    /// Returns the answer once. Whoever takes it closes the question, or sets `problem`.
    std::optional<Answer> take_answer() { return std::exchange(answer, std::nullopt); }

    bool replaces = false;  ///< the user has been asked whether to replace the file
    std::optional<Answer> answer;
};

/// Draws the question over the window while it is shown, with further `fields` below the name.
void draw_file_question(const char* title, FileQuestion& question, const std::function<void()>& fields = {});

}  // namespace lucarne::viewer
