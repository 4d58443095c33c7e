#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "gi/device/gl/shader_texts.h"

namespace lucarne::gi {

/// The shader files as they are on disk now, for who writes them; those that are not there are the program's
/// own. Only files that the program knows are read.
class ShaderFolder {
 public:
    /// `folder` holds the files as the project's root does ("gi/engines/vpl/shading/shade.comp").
    explicit ShaderFolder(std::filesystem::path folder) : folder_(std::move(folder)) { read(); }
    void read();
    const std::vector<ShaderText>& texts() const { return texts_; }

 private:
    std::filesystem::path folder_;
    std::deque<std::string> read_;  ///< what texts_ points at
    std::vector<ShaderText> texts_;
};

}  // namespace lucarne::gi
