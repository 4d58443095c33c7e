#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "io/core/error.h"

namespace lucarne {

/// A regular file that is changed in place, by one process at a time: a lock (flock) keeps others out for as
/// long as it is open, and goes with the process however that ends. Readers need no lock.
class UpdateFile {
 public:
    /// Errors: missing, unwritable or no regular file; locked by somebody else, who `busy` says it is.
    static Result<UpdateFile> open(const std::filesystem::path& path, const char* busy);
    /// The same of a file in a private folder (private_file.h); makes it where there is none, if it is to
    /// `create`.
    static Result<UpdateFile> open_private(const std::filesystem::path& path, bool create, const char* busy);
    UpdateFile(UpdateFile&& other) noexcept;
    UpdateFile& operator=(UpdateFile&& other) noexcept;
    ~UpdateFile();

    const std::filesystem::path& path() const { return path_; }
    Result<uint64_t> size() const;
    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Cuts the file off behind `bytes`.
    Result<void> truncate(uint64_t bytes);
    /// Returns when everything written so far is on the disk.
    Result<void> sync();

 private:
    UpdateFile(int fd, std::filesystem::path path) : fd_(fd), path_(std::move(path)) {}
    /// Empty: another file has the name by now.
    static Result<std::optional<UpdateFile>> lock(UpdateFile file, const char* busy);
    int fd_ = -1;
    std::filesystem::path path_;
};

}  // namespace lucarne
