#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "io/core/error.h"

/// Reading and writing at an offset of a handle, whole or with an error that names `path`: what the kinds of
/// file of this folder share.
namespace lucarne::file_io {

std::string reason(int code);  ///< of an errno
Result<void> write_all(int fd, uint64_t offset, std::span<const std::byte> data,
                       const std::filesystem::path& path);
Result<size_t> read_up_to(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path);
Result<void> read_exactly(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path);

}  // namespace lucarne::file_io
