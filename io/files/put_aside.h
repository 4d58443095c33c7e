#pragma once

#include <filesystem>
#include <string>

#include "io/core/error.h"

namespace lucarne {

/// Renames an unreadable file of the program's own to *.broken. Returns a sentence for the user that says so.
std::string put_aside(const std::filesystem::path& file, const Error& reason);

}  // namespace lucarne
