#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/device/common/shader_texts.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// Macros of a shader or an OpenCL program: names and values.
using Defines = std::vector<std::pair<std::string, std::string>>;

/// A shader with its includes resolved. `files[i]` is the file that `#line n i` refers to.
struct ShaderSource {
    std::string text;
    std::vector<std::string> files;
};

enum class ShaderLanguage : uint8_t { glsl, opencl };

/// Assembles `#version 450` (GLSL only), the defines, and the text of `path`. Every `#include "file"` is
/// replaced by that file's text the first time and by nothing after that. Includes in angle brackets are for
/// C++ and are dropped. Errors: a file that is not among `texts`.
Result<ShaderSource> shader_source(std::string_view path, const Defines& defines,
                                   const std::vector<ShaderText>& texts,
                                   ShaderLanguage language = ShaderLanguage::glsl);

/// Returns the first error of a compiler's log, with the file's name and line in place of the file's number.
/// Understands Mesa's "1:23(4): error: ..." and NVIDIA's "1(23) : error ...".
std::string readable_message(std::string_view log, const std::vector<std::string>& files);

}  // namespace lucarne::gi
