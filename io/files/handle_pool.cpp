#include "io/files/handle_pool.h"

#include <cerrno>
#include <optional>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lucarne {

Handle::~Handle() {
    if (fd_ >= 0) ::close(fd_);
}

uint64_t HandlePool::next_number() {
    const std::lock_guard lock(mutex_);
    return next_++;
}

uint64_t HandlePool::enrol(std::shared_ptr<const Handle> handle) {
    const uint64_t number = next_number();
    if (handle) keep(number, std::move(handle));
    return number;
}

int HandlePool::open_to_read(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

void HandlePool::leave(uint64_t number) {
    std::optional<std::shared_ptr<const Handle>> closed;  // closed after the lock is released
    const std::lock_guard lock(mutex_);
    closed = kept_.take(number);
}

/// Returns the file's open handle; null if none is kept.
std::shared_ptr<const Handle> HandlePool::kept_handle(uint64_t number) {
    const std::lock_guard lock(mutex_);
    const auto* kept = kept_.find(number);
    return kept ? *kept : nullptr;
}

/// Keeps `handle` and returns it. If another thread has opened the file meanwhile, returns that thread's
/// handle.
std::shared_ptr<const Handle> HandlePool::keep(uint64_t number, std::shared_ptr<const Handle> handle) {
    std::vector<std::shared_ptr<const Handle>> closed;  // closed after the lock is released
    const std::lock_guard lock(mutex_);
    if (const auto* kept = kept_.find(number)) return *kept;
    kept_.add(number, handle);
    while (kept_.size() > most_) closed.push_back(kept_.take_oldest());
    return handle;
}

Result<std::shared_ptr<const Handle>> HandlePool::acquire(uint64_t number, const std::filesystem::path& path,
                                                          const FileIdentity& identity) {
    if (auto kept = kept_handle(number)) return kept;
    auto handle = std::make_shared<const Handle>(opener_(path));
    if (handle->fd() < 0)
        return failed(path.string(), fmt::format("cannot be opened again ({})",
                                                 std::error_code(errno, std::generic_category()).message()));
    struct stat status {};
    if (::fstat(handle->fd(), &status) != 0 || identity != FileIdentity{status.st_dev, status.st_ino})
        return failed(path.string(), "has been replaced since it was opened", "open it again");
    return keep(number, handle);
}

size_t HandlePool::open() const {
    const std::lock_guard lock(mutex_);
    return kept_.size();
}

}  // namespace lucarne
