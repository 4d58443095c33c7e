#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "io/core/error.h"
#include "io/files/byte_source.h"
#include "io/files/handle_pool.h"

namespace lucarne {

/// A regular file opened for reading at any offset (pread). Directories, devices, and missing or unreadable
/// files are rejected with the reason. size() and modified() are those of the moment when it was opened.
class InputFile final : public ByteSource {
 public:
    /// Opens a file. With `pool` the file uses one of a bounded number of handles, and it must keep its name
    /// while it is read.
    static Result<InputFile> open(const std::filesystem::path& path,
                                  std::shared_ptr<HandlePool> pool = nullptr);
    /// The same, for sharing the file.
    static Result<std::shared_ptr<const InputFile>> open_shared(const std::filesystem::path& path,
                                                                std::shared_ptr<HandlePool> pool = nullptr);
    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&& other) noexcept;
    ~InputFile() override;

    Result<size_t> read_some(uint64_t offset, std::span<std::byte> out) const override;

 private:
    friend class OutputFile;
    InputFile() = default;
    Result<std::shared_ptr<const Handle>> handle() const;

    std::shared_ptr<const Handle> own_;  ///< null if there is a pool
    std::shared_ptr<HandlePool> pool_;
    uint64_t number_ = 0;  ///< the file's number in the pool
    FileIdentity identity_;
};

/// A file that appears under its name whole or not at all. It is written without a name (O_TMPFILE), so that
/// even SIGKILL leaves nothing. Where the file system cannot do that, it is written under a temporary name in
/// the same folder, and removed on failure. `commit` syncs the file and gives it its name. Any write that
/// fails (a full disk) is an error. The destructor of an uncommitted file leaves nothing behind. write_at is
/// thread-safe.
class OutputFile {
 public:
    /// Creates a file. Refuses a name that exists unless `overwrite` is set, and a folder that is missing or
    /// cannot be written.
    static Result<OutputFile> create(const std::filesystem::path& path, bool overwrite);
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    /// Writes at position(). There is no buffer: pass large pieces.
    Result<void> append(std::span<const std::byte> data);
    Result<void> append(std::string_view text);
    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    uint64_t position() const { return position_; }  ///< end of the appended data
    /// Returns a file that reads the first `bytes`, which must be written already, while more is appended. It
    /// may outlive this object.
    Result<InputFile> reader(uint64_t bytes) const;
    /// If only the name cannot be synced, returns an error, but the file stays.
    Result<void> commit();

 private:
    OutputFile() = default;
    int fd_ = -1;
    bool overwrite_ = false, committed_ = false;
    std::filesystem::path path_, temporary_;  ///< `temporary_` is empty for a file without a name
    uint64_t position_ = 0;
};

/// Write a whole file at once through OutputFile.
Result<void> write_file(const std::filesystem::path& path, std::string_view text, bool overwrite);
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> data, bool overwrite);

/// A scratch file. create() makes it without a name in `folder`, so that it disappears with the process,
/// however that ends. named() gives it a name, so that a resumed job can find it again.
class ScratchFile {
 public:
    static Result<ScratchFile> create(const std::filesystem::path& folder);
    /// Opens or creates `path`, and empties it unless `keep` is set. The caller must remove it.
    static Result<ScratchFile> named(const std::filesystem::path& path, bool keep);
    ScratchFile(ScratchFile&& other) noexcept;
    ScratchFile& operator=(ScratchFile&& other) noexcept;
    ~ScratchFile();

    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Returns the blocks of a range to the file system where that is possible. A hint: it never fails.
    void discard(uint64_t offset, uint64_t bytes);

 private:
    explicit ScratchFile(int fd, std::filesystem::path folder) : fd_(fd), folder_(std::move(folder)) {}
    int fd_ = -1;
    std::filesystem::path folder_;
};

/// Checks whether `path` can be written as an output, before long work starts. Refuses what
/// OutputFile::create refuses, but creates nothing.
Result<void> check_output(const std::filesystem::path& path, bool overwrite);

}  // namespace lucarne
