#include "io/files/file_io.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "io/core/interrupt.h"
#include "io/files/handle_pool.h"

namespace lucarne::file_io {
namespace {

/// Syncs a handle. Returns 0 or the errno.
int sync_error(int fd) {
    while (::fsync(fd) != 0)
        if (errno != EINTR) return errno;
    return 0;
}

}  // namespace

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::string reason(int code) {
    return std::strerror(code);
}

Result<void> write_all(int fd, uint64_t offset, std::span<const std::byte> data,
                       const std::filesystem::path& path) {
    while (!data.empty()) {
        const ssize_t n = ::pwrite(fd, data.data(), data.size(), static_cast<off_t>(offset));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return failed(path.string(),
                          fmt::format("cannot be written ({})", reason(n < 0 ? errno : ENOSPC)),
                          errno == ENOSPC || n == 0 ? "free some space or choose another disk" : "");
        offset += static_cast<uint64_t>(n);
        data = data.subspan(static_cast<size_t>(n));
    }
    return {};
}

Result<size_t> read_up_to(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path) {
    size_t done = 0;
    while (done < out.size()) {
        const ssize_t n =
            ::pread(fd, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return failed(path.string(), fmt::format("cannot be read ({})", reason(errno)));
        if (n == 0) break;
        done += static_cast<size_t>(n);
    }
    return done;
}

Result<void> read_exactly(int fd, uint64_t offset, std::span<std::byte> out,
                          const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const size_t got, read_up_to(fd, offset, out, path));
    if (got != out.size())
        return rejected(path.string(),
                        fmt::format("ends early: {} bytes wanted at {}, {} there", out.size(), offset, got));
    return {};
}

Result<void> sync(int fd, const std::filesystem::path& path) {
    if (const int error = sync_error(fd))
        return failed(path.string(), fmt::format("cannot be synced ({})", reason(error)));
    return {};
}

Result<void> sync_name(const std::filesystem::path& path) {
    const int folder = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const int error = folder < 0 ? errno : sync_error(folder);
    if (folder >= 0) ::close(folder);
    // fsync(2): EINVAL, EROFS and ENOTSUP mean that this cannot be synced. Some network file systems return
    // EBADF for folders.
    const bool unsupported =
        folder >= 0 && (error == EINVAL || error == EROFS || error == ENOTSUP || error == EBADF);
    const bool unreadable = folder < 0 && (error == EACCES || error == EPERM);
    if (error == 0 || unsupported || unreadable) return {};
    return failed(path.string(), fmt::format("is written, but its name cannot be synced ({})", reason(error)),
                  "check the disk: a power failure may still lose the file");
}

Result<void> name_written(const std::filesystem::path& part, const std::filesystem::path& name) {
    const Handle written(::open(part.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (written.fd() < 0) return failed(name.string(), fmt::format("cannot be synced ({})", reason(errno)));
    LUCARNE_TRY(sync(written.fd(), name));
    if (::rename(part.c_str(), name.c_str()) != 0)
        return failed(name.string(), fmt::format("cannot be given its name ({})", reason(errno)));
    return sync_name(name);
}

void remove_at_interrupt(const std::filesystem::path& name) {
    at_interrupt(name, [name] {
        ::unlink(name.c_str());
        return std::string();
    });
}

}  // namespace lucarne::file_io
