#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "gi/device/gl/shader_texts.h"

namespace lucarne::gi {

/// The shader files as they are on disk now, for developers of shaders. The embedded text stands in for
/// files that are not there. Only files that are embedded in the program are read.
class ShaderFolder {
 public:
    /// `folder` has the layout of the project's root ("gi/engines/vpl/shading/shade.comp").
    explicit ShaderFolder(std::filesystem::path folder) : folder_(std::move(folder)) { read(); }
    void read();
    const std::vector<ShaderText>& texts() const { return texts_; }

 private:
    std::filesystem::path folder_;
    std::deque<std::string> read_;  ///< owns the texts read from disk, to which texts_ points
    std::vector<ShaderText> texts_;
};

}  // namespace lucarne::gi
