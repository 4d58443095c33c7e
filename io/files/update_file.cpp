#include "io/files/update_file.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/file_io.h"
#include "io/files/private_file.h"

namespace lucarne {

using file_io::reason;

Result<UpdateFile> UpdateFile::open(const std::filesystem::path& path, const char* busy) {
    for (;;) {
        const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
        if (fd < 0) {
            auto why = fmt::format("cannot be opened for writing ({})", reason(errno));
            return errno == ENOENT ? rejected(path.string(), std::move(why))
                                   : failed(path.string(), std::move(why));
        }
        LUCARNE_ASSIGN(auto locked, lock(UpdateFile(fd, path), busy));
        if (locked) return std::move(*locked);
    }
}
Result<UpdateFile> UpdateFile::open_private(const std::filesystem::path& path, bool create,
                                            const char* busy) {
    for (;;) {
        LUCARNE_ASSIGN(const int fd, open_private_file(path, create));
        LUCARNE_ASSIGN(auto locked, lock(UpdateFile(fd, path), busy));
        if (locked) return std::move(*locked);
    }
}

Result<std::optional<UpdateFile>> UpdateFile::lock(UpdateFile file, const char* busy) {
    struct stat held {
    }, named{};
    if (::fstat(file.fd_, &held) != 0 || !S_ISREG(held.st_mode))
        return rejected(file.path_.string(), "is not a regular file");
    if (::flock(file.fd_, LOCK_EX | LOCK_NB) != 0)
        return failed(file.path_.string(), busy, "wait until it is done");
    // The previous holder of the lock may have replaced the file under this name, or removed it.
    if (::stat(file.path_.c_str(), &named) != 0 || named.st_ino != held.st_ino || named.st_dev != held.st_dev)
        return std::optional<UpdateFile>();
    return std::optional<UpdateFile>(std::move(file));
}

UpdateFile::UpdateFile(UpdateFile&& other) noexcept {
    *this = std::move(other);
}
UpdateFile& UpdateFile::operator=(UpdateFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(path_, other.path_);
    return *this;
}
UpdateFile::~UpdateFile() {
    if (fd_ >= 0) ::close(fd_);
}

Result<uint64_t> UpdateFile::size() const {
    struct stat status {};
    if (::fstat(fd_, &status) != 0)
        return failed(path_.string(), fmt::format("cannot be read ({})", reason(errno)));
    return static_cast<uint64_t>(status.st_size);
}

Result<void> UpdateFile::write_at(uint64_t offset, std::span<const std::byte> data) {
    return file_io::write_all(fd_, offset, data, path_);
}
Result<void> UpdateFile::read_at(uint64_t offset, std::span<std::byte> out) const {
    return file_io::read_exactly(fd_, offset, out, path_);
}

Result<void> UpdateFile::truncate(uint64_t bytes) {
    while (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0)
        if (errno != EINTR)
            return failed(path_.string(), fmt::format("cannot be cut off ({})", reason(errno)));
    return {};
}

Result<void> UpdateFile::sync() {
    return file_io::sync(fd_, path_);
}

}  // namespace lucarne
