#include "io/files/page_cache.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/handle_pool.h"

namespace lucarne {
namespace {

constexpr uint64_t kWindow = uint64_t{1} << 30;  ///< bytes that are mapped and queried at a time

/// Counts the pages of [offset, offset + bytes) that are in memory. The mapping itself loads none.
uint64_t resident_pages(int fd, uint64_t offset, uint64_t bytes, uint64_t page) {
    void* at = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
    if (at == MAP_FAILED) return 0;
    std::vector<unsigned char> pages((bytes + page - 1) / page);
    const bool known = ::mincore(at, bytes, pages.data()) == 0;
    ::munmap(at, bytes);
    return known ? static_cast<uint64_t>(std::ranges::count_if(pages, [](unsigned char p) { return p & 1; }))
                 : 0;
}

}  // namespace

Result<double> drop_page_cache(const std::filesystem::path& path) {
    const auto reason = [] { return std::error_code(errno, std::generic_category()).message(); };
    const Handle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat status {};
    if (file.fd() < 0 || ::fstat(file.fd(), &status) != 0)
        return rejected(path.string(), fmt::format("cannot be opened ({})", reason()));
    if (!S_ISREG(status.st_mode)) return rejected(path.string(), "is not a regular file");
    if (::fsync(file.fd()) != 0 && errno != EINVAL && errno != EROFS)
        return failed(path.string(), fmt::format("cannot be synced ({})", reason()));
    if (const int error = ::posix_fadvise(file.fd(), 0, 0, POSIX_FADV_DONTNEED); error != 0)
        return failed(path.string(), fmt::format("cannot be dropped from the page cache ({})",
                                                 std::error_code(error, std::generic_category()).message()));
    const auto size = static_cast<uint64_t>(status.st_size);
    const auto page = static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
    if (size == 0) return 0.0;
    uint64_t pages = 0;
    for (uint64_t offset = 0; offset < size; offset += kWindow)
        pages += resident_pages(file.fd(), offset, std::min(kWindow, size - offset), page);
    return static_cast<double>(pages) / static_cast<double>((size + page - 1) / page);
}

}  // namespace lucarne
