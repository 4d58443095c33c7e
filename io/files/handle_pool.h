#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include <sys/types.h>

#include "io/core/error.h"
#include "io/core/recently_used.h"

namespace lucarne {

/// A file descriptor. It is closed with its last user.
class Handle {
 public:
    explicit Handle(int fd) : fd_(fd) {}
    ~Handle();
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    int fd() const { return fd_; }

 private:
    int fd_;
};

/// Identifies the file that a name stood for when it was first opened.
struct FileIdentity {
    dev_t device = 0;
    ino_t inode = 0;
    bool operator==(const FileIdentity&) const = default;
};

/// Gives access to many files while a bounded number of handles is kept open. The least recently used handle
/// is closed, and its file is opened again when needed. In addition, the handles that threads are reading
/// from at the moment stay open. Thread-safe.
///
/// Files are opened and closed outside the lock, so a slow file (on a network) delays only its own readers.
class HandlePool {
 public:
    /// Opens a file for reading. Returns a file descriptor, or -1 and sets errno.
    using Opener = std::function<int(const std::filesystem::path&)>;

    explicit HandlePool(size_t most, Opener opener = open_to_read)
        : most_(most), opener_(std::move(opener)) {}
    static int open_to_read(const std::filesystem::path& path);

    /// Returns a number for a file that will be acquired later. `handle` is its handle, if it is open
    /// already.
    uint64_t enrol(std::shared_ptr<const Handle> handle = nullptr);
    void leave(uint64_t number);
    /// Returns a handle of the file. Errors: the file can no longer be opened, or its name stands for another
    /// file now.
    Result<std::shared_ptr<const Handle>> acquire(uint64_t number, const std::filesystem::path& path,
                                                  const FileIdentity& identity);
    size_t open() const;  ///< number of handles kept open now

 private:
    std::shared_ptr<const Handle> kept_handle(uint64_t number);
    uint64_t next_number();
    std::shared_ptr<const Handle> keep(uint64_t number, std::shared_ptr<const Handle> handle);

    const size_t most_;
    const Opener opener_;
    mutable std::mutex mutex_;
    uint64_t next_ = 0;
    RecentlyUsed<uint64_t, std::shared_ptr<const Handle>> kept_;
};

}  // namespace lucarne
