#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/device/gl/shader_texts.h"

namespace lucarne::gi {

/// A shader with its includes in place. `files[i]` is the file that `#line n i` speaks of.
struct ShaderSource {
    std::string text;
    std::vector<std::string> files;
};

enum class ShaderLanguage : uint8_t { glsl, opencl };

/// Puts `#version 450` (of GLSL), the defines, and the text of `path` together; every `#include "file"` is
/// replaced by that file's text the first time it is met and by nothing after. Includes in angle brackets are
/// C++'s and dropped. Errors: a file that is not among `texts`.
Result<ShaderSource> shader_source(std::string_view path, const Defines& defines,
                                   const std::vector<ShaderText>& texts,
                                   ShaderLanguage language = ShaderLanguage::glsl);

/// The first message of a compiler's log with the file's name and line in place of the file's number:
/// understands Mesa's "1:23(4): error: ..." and NVIDIA's "1(23) : error ...".
std::string readable_message(std::string_view log, const std::vector<std::string>& files);

}  // namespace lucarne::gi
