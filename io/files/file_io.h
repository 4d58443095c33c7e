#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/core/error.h"

/// Reading and writing at an offset of a handle, shared by the file classes of this folder. Each function
/// completes or returns an error that names `path`.
namespace lucarne::file_io {

std::filesystem::path folder_of(const std::filesystem::path& path);  ///< "." for a bare name

std::string reason(int code);  ///< the text of an errno
Result<void> write_all(int fd, uint64_t offset, std::span<const std::byte> data,
                       const std::filesystem::path& path);
Result<size_t> read_up_to(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path);
Result<void> read_exactly(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path);
/// Lets an interrupt remove an unfinished file (at_interrupt).
void remove_at_interrupt(const std::filesystem::path& name);
/// Waits until everything written is on the disk. `path` only names the file in errors.
Result<void> sync(int fd, const std::filesystem::path& path);
/// Waits until the name of `path`, new or replaced, is on the disk. Does nothing on a file system that cannot
/// sync folders, or for a folder that may be written but not read. Any other error (EIO, ENOSPC, EDQUOT)
/// means that the name may be lost when the power fails.
Result<void> sync_name(const std::filesystem::path& path);
/// Syncs the file `part`, which another program has written, renames it to its final `name` in the same
/// folder and syncs the name. Replaces an existing file of that name.
Result<void> name_written(const std::filesystem::path& part, const std::filesystem::path& name);

}  // namespace lucarne::file_io
