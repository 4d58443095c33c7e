#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "io/core/error.h"

namespace lucarne {

/// Bytes that can be read at any offset: a file (InputFile) or memory (MemorySource). Thread-safe.
class ByteSource {
 public:
    virtual ~ByteSource() = default;

    /// The name for error messages. Its extension tells the format; its folder is where related files are.
    const std::filesystem::path& path() const { return path_; }
    uint64_t size() const { return size_; }
    /// Modification time in ns since 1970; 0 where unknown. With the size it identifies a state of the file.
    int64_t modified() const { return modified_; }

    /// Reads up to `out.size()` bytes at `offset` and returns how many were read. Fewer only at the end.
    virtual Result<size_t> read_some(uint64_t offset, std::span<std::byte> out) const = 0;
    /// Reads exactly `out.size()` bytes at `offset`. Fewer is an error that says so (a truncated file).
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;

 protected:
    ByteSource() = default;
    ByteSource(std::filesystem::path path, uint64_t size, int64_t modified)
        : path_(std::move(path)), size_(size), modified_(modified) {}
    ByteSource(ByteSource&&) noexcept = default;
    ByteSource& operator=(ByteSource&&) noexcept = default;

    std::filesystem::path path_;
    uint64_t size_ = 0;
    int64_t modified_ = 0;
};

class MemorySource final : public ByteSource {
 public:
    /// `bytes` must outlive the object.
    MemorySource(std::filesystem::path path, std::span<const std::byte> bytes, int64_t modified = 0)
        : ByteSource(std::move(path), bytes.size(), modified), bytes_(bytes) {}
    MemorySource(std::filesystem::path path, std::vector<std::byte> bytes, int64_t modified = 0)
        : ByteSource(std::move(path), bytes.size(), modified), owned_(std::move(bytes)), bytes_(owned_) {}
    MemorySource(MemorySource&&) = delete;

    Result<size_t> read_some(uint64_t offset, std::span<std::byte> out) const override;

 private:
    std::vector<std::byte> owned_;
    std::span<const std::byte> bytes_;
};

}  // namespace lucarne
