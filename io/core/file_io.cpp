#include "io/core/file_io.h"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <unistd.h>

namespace lucarne::file_io {

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

}  // namespace lucarne::file_io
