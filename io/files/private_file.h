#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/core/error.h"

/// Folders and files under names that others can guess, in places where others may write: what is opened is
/// this user's own, never a link, and nobody else can put anything in its place.
namespace lucarne {

/// Makes the folder for this user alone (0700), or takes the one that is there. Errors: it cannot be made;
/// it is a link, another user's, or others may write to it.
Result<void> make_private_folder(const std::filesystem::path& folder);
/// Makes a folder of a name that nobody can guess in `parent`.
Result<std::filesystem::path> new_private_folder(const std::filesystem::path& parent);
/// Removes these files from a private folder and then the folder. What else it holds stays, and the folder
/// with it.
void remove_private_folder(const std::filesystem::path& folder, std::span<const std::string> files);
/// Removes the files alone.
void remove_private_files(const std::filesystem::path& folder, std::span<const std::string> files);
/// Opens a regular file of this user in a private folder for reading and writing; the caller closes the
/// handle. Errors: the folder or the file is a link, another user's, or the file has a second name.
Result<int> open_private_file(const std::filesystem::path& path, bool create);

}  // namespace lucarne
