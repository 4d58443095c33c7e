#pragma once

#include <filesystem>

namespace lucarne {

/// Returns the value of an environment variable if it is an absolute path. Returns an empty path otherwise:
/// other values must be ignored (XDG Base Directory Specification 0.8).
std::filesystem::path absolute_folder(const char* variable);

/// Returns the folder for a kind of this user's files: "lucarne" in the folder that `variable` names,
/// otherwise in `below_home` of the user's home folder. Empty if neither exists. Creates nothing.
std::filesystem::path user_folder(const char* variable, const char* below_home);

}  // namespace lucarne
