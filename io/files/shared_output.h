#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "io/core/error.h"

namespace lucarne {

/// An output that several processes write, also of several machines that share its folder. One of them
/// creates and commits it, the others open it. Like OutputFile it appears under its name whole or not at all;
/// until then its name is shared_name(path). Only one process at a time can create it for an output. An
/// interrupt of any of the processes removes it, because its creator may have been killed. What is left when
/// all were killed is replaced by the next one.
class SharedOutput {
 public:
    /// Errors: those of OutputFile::create; another process is writing the output.
    static Result<SharedOutput> create(const std::filesystem::path& path, bool overwrite);
    static Result<SharedOutput> open(const std::filesystem::path& path);
    SharedOutput(SharedOutput&& other) noexcept;
    SharedOutput& operator=(SharedOutput&& other) noexcept;
    /// Removes the file if this process created and has not committed it.
    ~SharedOutput();

    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Waits until everything written is on the disk, where other machines can read it.
    Result<void> sync();
    /// Syncs the file and gives it its name; for its creator.
    Result<void> commit();

 private:
    SharedOutput() = default;
    int fd_ = -1;
    bool created_ = false, overwrite_ = false, committed_ = false;
    std::filesystem::path path_;
};

std::filesystem::path shared_name(const std::filesystem::path& path);

}  // namespace lucarne
