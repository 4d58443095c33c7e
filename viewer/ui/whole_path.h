#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace lucarne::viewer {

/// Returns a path as messages show it and settings keep it: absolute, without "." and "..".
inline std::string whole_path(const std::filesystem::path& path) {
    std::error_code unknown;
    const auto whole = std::filesystem::absolute(path, unknown);
    return unknown ? path.string() : whole.lexically_normal().string();
}

}  // namespace lucarne::viewer
