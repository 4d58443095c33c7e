#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/core/error.h"

/// Folders and files with guessable names in places where other users may write. The functions only open what
/// belongs to this user and never follow a link, and nobody else can replace what they opened.
namespace lucarne {

/// Creates the folder for this user alone (0700), or accepts an existing one. Errors: it cannot be created;
/// it is a link; it belongs to another user; others may write to it.
Result<void> make_private_folder(const std::filesystem::path& folder);
/// Creates a folder in `parent` whose name nobody can guess.
Result<std::filesystem::path> new_private_folder(const std::filesystem::path& parent);
/// Removes these files from a private folder, and then the folder. If the folder holds anything else, both
/// stay.
void remove_private_folder(const std::filesystem::path& folder, std::span<const std::string> files);
/// Removes only the files.
void remove_private_files(const std::filesystem::path& folder, std::span<const std::string> files);
/// Opens a regular file of this user in a private folder for reading and writing. The caller closes the
/// handle. Errors: the folder or the file is a link or belongs to another user, or the file has a second
/// name.
Result<int> open_private_file(const std::filesystem::path& path, bool create);

}  // namespace lucarne
