#include "io/files/shared_output.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/core/interrupt.h"
#include "io/files/file.h"
#include "io/files/file_io.h"

namespace lucarne {

using file_io::reason;

namespace {

/// Locks a whole file for its handle, also against other machines where the file system can do that.
bool lock_whole(int fd) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    return ::fcntl(fd, F_OFD_SETLK, &lock) == 0 || (errno != EAGAIN && errno != EACCES);
}

/// Removes the opened file at an interrupt, unless its name stands for another one by then: it was given its
/// final name, and the next conversion to the same output has begun.
void remove_at_interrupt(const std::filesystem::path& name, int fd) {
    struct stat held {};
    if (::fstat(fd, &held) != 0) return;
    at_interrupt(name, [name, held] {
        struct stat named {};
        if (::stat(name.c_str(), &named) == 0 && named.st_ino == held.st_ino && named.st_dev == held.st_dev)
            ::unlink(name.c_str());
        return std::string();
    });
}

}  // namespace

std::filesystem::path shared_name(const std::filesystem::path& path) {
    return file_io::folder_of(path) / fmt::format(".{}.lucarne-part", path.filename().string());
}

Result<SharedOutput> SharedOutput::create(const std::filesystem::path& path, bool overwrite) {
    LUCARNE_TRY(check_output(path, overwrite));
    const auto name = shared_name(path);
    for (;;) {
        SharedOutput output;
        output.path_ = path;
        output.overwrite_ = overwrite;
        output.fd_ = ::open(name.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (output.fd_ < 0)
            return failed(path.string(), fmt::format("cannot be created ({})", reason(errno)));
        struct stat held {
        }, named{};
        if (::fstat(output.fd_, &held) != 0 || !S_ISREG(held.st_mode))
            return failed(name.string(), "is not a regular file", "remove it");
        if (!lock_whole(output.fd_))
            return failed(path.string(), "another conversion to this cache is running",
                          "wait until it is done, or choose another name");
        // The previous holder of the lock may have renamed or removed the file.
        if (::stat(name.c_str(), &named) != 0 || named.st_ino != held.st_ino || named.st_dev != held.st_dev)
            continue;
        if (::ftruncate(output.fd_, 0) != 0)
            return failed(name.string(), fmt::format("cannot be emptied ({})", reason(errno)));
        output.created_ = true;
        remove_at_interrupt(name, output.fd_);
        return output;
    }
}

Result<SharedOutput> SharedOutput::open(const std::filesystem::path& path) {
    SharedOutput output;
    const auto name = shared_name(path);
    output.path_ = path;
    output.fd_ = ::open(name.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (output.fd_ < 0)
        return failed(path.string(), fmt::format("cannot be opened for writing ({})", reason(errno)),
                      "write it to a folder that all nodes share");
    remove_at_interrupt(name, output.fd_);
    return output;
}

SharedOutput::SharedOutput(SharedOutput&& other) noexcept {
    *this = std::move(other);
}
SharedOutput& SharedOutput::operator=(SharedOutput&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(created_, other.created_);
    std::swap(overwrite_, other.overwrite_);
    std::swap(committed_, other.committed_);
    std::swap(path_, other.path_);
    return *this;
}
SharedOutput::~SharedOutput() {
    if (fd_ < 0) return;
    const auto name = shared_name(path_);
    if (created_ && !committed_) ::unlink(name.c_str());  // still locked: nobody else has begun
    ::close(fd_);
    forget_interrupt(name);
}

Result<void> SharedOutput::write_at(uint64_t offset, std::span<const std::byte> data) {
    return file_io::write_all(fd_, offset, data, path_);
}
Result<void> SharedOutput::read_at(uint64_t offset, std::span<std::byte> out) const {
    return file_io::read_exactly(fd_, offset, out, path_);
}
Result<void> SharedOutput::sync() {
    return file_io::sync(fd_, path_);
}

Result<void> SharedOutput::commit() {
    LUCARNE_TRY(sync());
    if (!overwrite_ && ::access(path_.c_str(), F_OK) == 0)
        return failed(path_.string(), "exists already", "choose another name or pass --overwrite");
    if (::rename(shared_name(path_).c_str(), path_.c_str()) != 0)
        return failed(path_.string(), fmt::format("cannot be given its name ({})", reason(errno)));
    committed_ = true;
    return file_io::sync_name(path_);
}

}  // namespace lucarne
