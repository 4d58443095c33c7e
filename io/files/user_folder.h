#pragma once

#include <filesystem>

namespace lucarne {

/// The value of an environment variable that is an absolute path; empty for others, which do not count (XDG
/// Base Directory Specification 0.8).
std::filesystem::path absolute_folder(const char* variable);

/// Where this program keeps files of a kind for its user: "lucarne" in the folder that `variable` names, or
/// else in `below_home` of the user's own. Empty where there is neither. Nothing is made.
std::filesystem::path user_folder(const char* variable, const char* below_home);

}  // namespace lucarne
