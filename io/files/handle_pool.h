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

/// A file descriptor that is closed with its last user.
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

/// Which file a name stood for when it was first opened.
struct FileIdentity {
    dev_t device = 0;
    ino_t inode = 0;
    bool operator==(const FileIdentity&) const = default;
};

/// Handles of many files of which only so many are open at once: the longest unused is closed and opened
/// again when it is needed. Beside those, as many are open as threads read at the moment. Thread-safe.
///
/// Files are opened and closed outside the lock: a slow one (on a network) holds up only those who read it.
class HandlePool {
 public:
    /// Opens a file for reading: a file descriptor, or -1 and errno.
    using Opener = std::function<int(const std::filesystem::path&)>;

    explicit HandlePool(size_t most, Opener opener = open_to_read)
        : most_(most), opener_(std::move(opener)) {}
    static int open_to_read(const std::filesystem::path& path);

    /// A number for a file that will be asked for again; `handle` where it is open.
    uint64_t enrol(std::shared_ptr<const Handle> handle = nullptr);
    void leave(uint64_t number);
    /// Errors: the file cannot be opened (any more), or its name stands for another file now.
    Result<std::shared_ptr<const Handle>> acquire(uint64_t number, const std::filesystem::path& path,
                                                  const FileIdentity& identity);
    size_t open() const;  ///< handles kept now

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
