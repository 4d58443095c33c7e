#include "viewer/project/lock.h"

#include <cerrno>
#include <climits>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lucarne::viewer {
namespace {

constexpr int kTries = 10;
constexpr size_t kMostText = 200;

/// Returns what the lock's holder has written about itself.
std::string holder(int fd) {
    char text[kMostText];
    const ssize_t size = ::pread(fd, text, sizeof text, 0);
    std::string who;
    for (ssize_t i = 0; i < size && text[i] >= ' ' && text[i] < 127; ++i) who += text[i];
    return who.empty() ? "another process" : who;
}

std::string own_name() {
    char host[HOST_NAME_MAX + 1] = "";
    ::gethostname(host, HOST_NAME_MAX);
    return fmt::format("process {} on {}\n", ::getpid(), host);
}

/// Whether the opened file still has its name: the former holder removes it.
bool has_name(int fd, const std::filesystem::path& path) {
    struct stat opened {
    }, named{};
    return ::fstat(fd, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

}  // namespace

std::string ProjectLock::take(const std::filesystem::path& project) {
    release();
    lock_ = project;
    lock_ += ".lock";
    for (int i = 0; i < kTries; ++i) {
        const int fd = ::open(lock_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
        if (fd < 0) return "";
        if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
            const bool held = errno == EWOULDBLOCK;
            const std::string who = held ? holder(fd) : "";
            ::close(fd);
            return who;
        }
        if (has_name(fd, lock_)) {
            const std::string name = own_name();
            // Without its text the lock holds as well.
            if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, name.data(), name.size(), 0) < 0) errno = 0;
            fd_ = fd;
            return "";
        }
        ::close(fd);
    }
    return "another process";
}

void ProjectLock::release() {
    if (fd_ < 0) return;
    ::unlink(lock_.c_str());  // before the lock is free: it is still this object's
    ::close(std::exchange(fd_, -1));
}

}  // namespace lucarne::viewer
