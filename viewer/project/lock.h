#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace lucarne::viewer {

/// Keeps a second window from writing the project that a window has open. The lock is that of a file beside
/// the project (flock), which names the process. The system releases it when the process ends, however that
/// happens, so no lock goes stale; network file systems share it between hosts.
class ProjectLock {
 public:
    ProjectLock() = default;
    ProjectLock(ProjectLock&& other) noexcept
        : lock_(std::move(other.lock_)), fd_(std::exchange(other.fd_, -1)) {}
    ProjectLock& operator=(ProjectLock&& other) noexcept {
        std::swap(lock_, other.lock_);
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~ProjectLock() { release(); }

    /// Locks a project's file, which need not exist. Returns who holds the lock, for example "process 12 on
    /// host"; empty: this object, or nobody because the folder or its file system cannot hold a lock.
    std::string take(const std::filesystem::path& project);
    void release();

 private:
    std::filesystem::path lock_;
    int fd_ = -1;
};

}  // namespace lucarne::viewer
