#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "io/core/error.h"

namespace lucarne {

/// A regular file that one process at a time changes in place. A lock (flock) excludes other writers while
/// the file is open; it ends with the process, however that ends. Readers need no lock.
class UpdateFile {
 public:
    /// Opens and locks a file. Errors: it is missing, cannot be written or is not a regular file; somebody
    /// else has locked it (`busy` is the message for that).
    static Result<UpdateFile> open(const std::filesystem::path& path, const char* busy);
    /// The same for a file in a private folder (private_file.h). Creates a missing file if `create` is set.
    static Result<UpdateFile> open_private(const std::filesystem::path& path, bool create, const char* busy);
    UpdateFile(UpdateFile&& other) noexcept;
    UpdateFile& operator=(UpdateFile&& other) noexcept;
    ~UpdateFile();

    const std::filesystem::path& path() const { return path_; }
    Result<uint64_t> size() const;
    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Cuts the file off after `bytes`.
    Result<void> truncate(uint64_t bytes);
    /// Waits until everything written so far is on the disk.
    Result<void> sync();

 private:
    UpdateFile(int fd, std::filesystem::path path) : fd_(fd), path_(std::move(path)) {}
    /// Locks a file. Returns nothing if its name has come to stand for another file.
    static Result<std::optional<UpdateFile>> lock(UpdateFile file, const char* busy);
    int fd_ = -1;
    std::filesystem::path path_;
};

}  // namespace lucarne
