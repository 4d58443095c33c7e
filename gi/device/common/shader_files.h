#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gi/device/common/shader_texts.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// The files that shaders and OpenCL programs are compiled from: those embedded in the program, or, for their
/// developers, those on disk. Keeps the first problem with them for the user.
class ShaderFiles {
 public:
    /// Adds a file to those that are embedded, or replaces one, for engines and kernels of tests. Programs
    /// compiled earlier keep their text.
    void add(std::string path, std::string text);
    /// Reads the files in `folder`, which has the layout of the project's root ("gi/post/tone_map.comp"). The
    /// embedded text stands in for files that are not there. Only files that are embedded in the program are
    /// read.
    void use_folder(std::filesystem::path folder);
    /// Reads the folder again and forgets the problem. Does nothing without a folder.
    void read_again();
    bool from_folder() const { return folder_.has_value(); }
    /// Returns the files as they are now, and as they are embedded.
    const std::vector<ShaderText>& texts() const { return folder_ ? texts_ : embedded_; }
    const std::vector<ShaderText>& embedded() const { return embedded_; }

    /// Warns of an error in a file.
    void note_problem(const Error& error);
    /// Returns the first error noted since the folder was last read; empty if there is none.
    const std::string& problem() const { return problem_; }

 private:
    void read();

    std::vector<ShaderText> embedded_ = shader_texts(), texts_;
    std::optional<std::filesystem::path> folder_;
    std::deque<std::string> added_, read_;  ///< own texts to which embedded_ and texts_ point
    std::string problem_;
};

}  // namespace lucarne::gi
