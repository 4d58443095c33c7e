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

/// A regular file opened for reading at any offset (pread). Directories, devices, missing and unreadable
/// files are rejected with their reason. Its size and time are those of when it was opened.
class InputFile final : public ByteSource {
 public:
    /// With `pool` the handle is one of a bounded number, and the file must keep its name while it is read.
    static Result<InputFile> open(const std::filesystem::path& path,
                                  std::shared_ptr<HandlePool> pool = nullptr);
    /// The same for who hands it on.
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

    std::shared_ptr<const Handle> own_;  ///< none where there is a pool
    std::shared_ptr<HandlePool> pool_;
    uint64_t number_ = 0;  ///< in the pool
    FileIdentity identity_;
};

/// A file that appears under its name whole or not at all: it is written nameless (O_TMPFILE, so that even
/// SIGKILL leaves nothing) or, where the file system cannot do that, beside its name and removed on failure.
/// `commit` syncs it and gives it its name. Any write that fails (a full disk) is an error; the destructor of
/// an uncommitted file leaves nothing behind. write_at is thread-safe.
class OutputFile {
 public:
    /// Refuses a name that exists unless `overwrite`; refuses a folder that is missing or cannot be written.
    static Result<OutputFile> create(const std::filesystem::path& path, bool overwrite);
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    Result<void> append(
        std::span<const std::byte> data);  ///< at position(); unbuffered: hand over large pieces
    Result<void> append(std::string_view text);
    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    uint64_t position() const { return position_; }  ///< the end of what `append` wrote
    /// The first `bytes`, which are written, to be read while more is appended; it outlives this object.
    Result<InputFile> reader(uint64_t bytes) const;
    Result<void> commit();  ///< where only its name cannot be synced, that is an error and the file stays

 private:
    OutputFile() = default;
    int fd_ = -1;
    bool overwrite_ = false, committed_ = false;
    std::filesystem::path path_, temporary_;  ///< `temporary_` is empty for a nameless file
    uint64_t position_ = 0;
};

/// A whole file at once, as OutputFile writes it.
Result<void> write_file(const std::filesystem::path& path, std::string_view text, bool overwrite);
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> data, bool overwrite);

/// A scratch file. Nameless in `folder`: gone with the process however it ends; or under a name, to be found
/// again by who resumes the work.
class ScratchFile {
 public:
    static Result<ScratchFile> create(const std::filesystem::path& folder);
    /// Opens or makes `path`; empties it unless `keep`. Who removes it is the caller's business.
    static Result<ScratchFile> named(const std::filesystem::path& path, bool keep);
    ScratchFile(ScratchFile&& other) noexcept;
    ScratchFile& operator=(ScratchFile&& other) noexcept;
    ~ScratchFile();

    Result<void> write_at(uint64_t offset, std::span<const std::byte> data);
    Result<void> read_at(uint64_t offset, std::span<std::byte> out) const;
    /// Gives the blocks of a range back to the file system where it can; a hint, never an error.
    void discard(uint64_t offset, uint64_t bytes);

 private:
    explicit ScratchFile(int fd, std::filesystem::path folder) : fd_(fd), folder_(std::move(folder)) {}
    int fd_ = -1;
    std::filesystem::path folder_;
};

/// Why `path` can be written as an output, checked before long work starts: the same refusals as
/// OutputFile::create, with nothing created.
Result<void> check_output(const std::filesystem::path& path, bool overwrite);

}  // namespace lucarne
