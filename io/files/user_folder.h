#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace lucarne {

/// Returns the value of an environment variable if it is an absolute path. Returns an empty path otherwise:
/// other values must be ignored (XDG Base Directory Specification 0.8).
std::filesystem::path absolute_folder(const char* variable);

/// Returns the folder for a kind of this user's files: "lucarne" in the folder that `variable` names,
/// otherwise in `below_home` of the user's home folder. Empty if neither exists. Creates nothing.
std::filesystem::path user_folder(const char* variable, const char* below_home);

/// Returns a name for what is kept about a file: 16 hexadecimal digits made of its path.
std::string kept_name(std::string_view path);

}  // namespace lucarne
