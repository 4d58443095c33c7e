#include "io/files/file.h"

#include <cerrno>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/core/interrupt.h"
#include "io/files/file_io.h"
#include "io/files/private_file.h"

namespace lucarne {

using file_io::folder_of;
using file_io::read_exactly;
using file_io::read_up_to;
using file_io::reason;
using file_io::remove_at_interrupt;
using file_io::write_all;

namespace {

/// Returns a temporary name for an output that is not whole yet. The name holds this process's id and is not
/// left over from another process.
std::filesystem::path unused_name(const std::filesystem::path& folder) {
    struct stat status {};
    for (int n = 0;; ++n) {
        auto name = folder / fmt::format(".lucarne-{}-{}.part", ::getpid(), n);
        if (::lstat(name.c_str(), &status) != 0) return name;
    }
}

}  // namespace

Result<InputFile> InputFile::open(const std::filesystem::path& path, std::shared_ptr<HandlePool> pool) {
    // Without O_NONBLOCK, opening a FIFO would block forever.
    auto handle = std::make_shared<const Handle>(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (handle->fd() < 0)
        return rejected(path.empty() ? "''" : path.string(),
                        fmt::format("cannot be opened ({})", reason(errno)));
    struct stat status {};
    if (::fstat(handle->fd(), &status) != 0 || !S_ISREG(status.st_mode))
        return rejected(path.string(), "is not a regular file");
    InputFile file;
    file.size_ = static_cast<uint64_t>(status.st_size);
    file.identity_ = {status.st_dev, status.st_ino};
    file.path_ = path;
    if (pool) {
        file.number_ = pool->enrol(std::move(handle));
        file.pool_ = std::move(pool);
    } else {
        file.own_ = std::move(handle);
    }
    constexpr int64_t kSecond = 1'000'000'000;
    file.modified_ = status.st_mtim.tv_sec * kSecond + status.st_mtim.tv_nsec;
    return file;
}

Result<std::shared_ptr<const InputFile>> InputFile::open_shared(const std::filesystem::path& path,
                                                                std::shared_ptr<HandlePool> pool) {
    LUCARNE_ASSIGN(InputFile file, open(path, std::move(pool)));
    return std::make_shared<const InputFile>(std::move(file));
}

InputFile::InputFile(InputFile&& other) noexcept {
    *this = std::move(other);
}
InputFile& InputFile::operator=(InputFile&& other) noexcept {
    std::swap(own_, other.own_);
    std::swap(pool_, other.pool_);
    std::swap(number_, other.number_);
    std::swap(identity_, other.identity_);
    std::swap(size_, other.size_);
    std::swap(modified_, other.modified_);
    std::swap(path_, other.path_);
    return *this;
}
InputFile::~InputFile() {
    if (pool_) pool_->leave(number_);
}

Result<std::shared_ptr<const Handle>> InputFile::handle() const {
    if (!pool_) return own_;
    return pool_->acquire(number_, path_, identity_);
}

Result<size_t> InputFile::read_some(uint64_t offset, std::span<std::byte> out) const {
    LUCARNE_ASSIGN(const auto open_handle, handle());
    return read_up_to(open_handle->fd(), offset, out, path_);
}

Result<void> check_output(const std::filesystem::path& path, bool overwrite) {
    struct stat status {};
    if (path.filename().empty()) return bad_arguments(path.string(), "is not a file name");
    if (::lstat(path.c_str(), &status) == 0) {  // a dangling link takes the name as well
        if (S_ISDIR(status.st_mode)) return failed(path.string(), "is a folder", "choose a file name");
        if (!S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode))
            return failed(path.string(), "is a device or another special file", "choose a file name");
        if (!overwrite)
            return failed(path.string(), "exists already", "choose another name or pass --overwrite");
    } else if (errno == ENAMETOOLONG) {
        return failed(path.string(), fmt::format("cannot be created ({})", reason(errno)));
    }
    const auto folder = folder_of(path);
    if (::stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode))
        return failed(path.string(), fmt::format("the folder {} does not exist", folder.string()),
                      "create it first");
    if (::access(folder.c_str(), W_OK) != 0)
        return failed(path.string(), fmt::format("cannot be created ({})", reason(errno)),
                      "choose another folder");
    return {};
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& path, bool overwrite) {
    LUCARNE_TRY(check_output(path, overwrite));
    OutputFile file;
    file.path_ = path;
    file.overwrite_ = overwrite;
    file.fd_ = ::open(folder_of(path).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (file.fd_ < 0) {
        const auto name = unused_name(folder_of(path));
        file.fd_ = ::open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
        if (file.fd_ < 0) return failed(path.string(), fmt::format("cannot be created ({})", reason(errno)));
        file.temporary_ = name;
        remove_at_interrupt(name);
    }
    return file;
}

OutputFile::OutputFile(OutputFile&& other) noexcept {
    *this = std::move(other);
}
OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(overwrite_, other.overwrite_);
    std::swap(committed_, other.committed_);
    std::swap(path_, other.path_);
    std::swap(temporary_, other.temporary_);
    std::swap(position_, other.position_);
    return *this;
}
OutputFile::~OutputFile() {
    if (fd_ >= 0) ::close(fd_);
    if (temporary_.empty()) return;
    if (!committed_) ::unlink(temporary_.c_str());
    forget_interrupt(temporary_);
}

Result<void> OutputFile::append(std::span<const std::byte> data) {
    LUCARNE_TRY(write_all(fd_, position_, data, path_));
    position_ += data.size();
    return {};
}
Result<void> OutputFile::append(std::string_view text) {
    return append(std::as_bytes(std::span(text)));
}
Result<void> OutputFile::write_at(uint64_t offset, std::span<const std::byte> data) {
    return write_all(fd_, offset, data, path_);
}
Result<void> OutputFile::read_at(uint64_t offset, std::span<std::byte> out) const {
    return read_exactly(fd_, offset, out, path_);
}

Result<InputFile> OutputFile::reader(uint64_t bytes) const {
    const int fd = ::fcntl(fd_, F_DUPFD_CLOEXEC, 0);
    if (fd < 0) return failed(path_.string(), fmt::format("cannot be read ({})", reason(errno)));
    InputFile file;
    file.own_ = std::make_shared<const Handle>(fd);
    file.size_ = bytes;
    file.path_ = path_;
    return file;
}

Result<void> OutputFile::commit() {
    LUCARNE_TRY(file_io::sync(fd_, path_));
    if (temporary_.empty()) {
        // linkat never replaces a name. An overwrite therefore links a temporary name and renames it.
        const std::string self = fmt::format("/proc/self/fd/{}", fd_);
        const auto name = overwrite_ ? unused_name(folder_of(path_)) : path_;
        if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0)
            return failed(path_.string(), fmt::format("cannot be given its name ({})", reason(errno)));
        if (overwrite_) {
            temporary_ = name;
            remove_at_interrupt(name);
        }
    } else if (!overwrite_ && ::access(path_.c_str(), F_OK) == 0) {
        return failed(path_.string(), "exists already", "choose another name or pass --overwrite");
    }
    if (!temporary_.empty() && ::rename(temporary_.c_str(), path_.c_str()) != 0)
        return failed(path_.string(), fmt::format("cannot be given its name ({})", reason(errno)));
    committed_ = true;
    return file_io::sync_name(path_);
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> data, bool overwrite) {
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, overwrite));
    LUCARNE_TRY(file.append(data));
    return file.commit();
}
Result<void> write_file(const std::filesystem::path& path, std::string_view text, bool overwrite) {
    return write_file(path, std::as_bytes(std::span(text)), overwrite);
}

Result<ScratchFile> ScratchFile::create(const std::filesystem::path& folder) {
    int fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (fd < 0) {
        std::string name = (folder / "lucarne-XXXXXX").string();
        fd = ::mkstemp(name.data());
        if (fd < 0)
            return failed(folder.string(),
                          fmt::format("no temporary file can be made here ({})", reason(errno)),
                          "choose another folder with --temp");
        ::unlink(name.c_str());
    }
    return ScratchFile(fd, folder);
}

Result<ScratchFile> ScratchFile::named(const std::filesystem::path& path, bool keep) {
    LUCARNE_ASSIGN(const int fd, open_private_file(path, true));
    ScratchFile file(fd, path.parent_path());
    if (!keep && ::ftruncate(fd, 0) != 0)
        return failed(path.string(), fmt::format("cannot be emptied ({})", reason(errno)));
    return file;
}

ScratchFile::ScratchFile(ScratchFile&& other) noexcept {
    *this = std::move(other);
}
ScratchFile& ScratchFile::operator=(ScratchFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(folder_, other.folder_);
    return *this;
}
ScratchFile::~ScratchFile() {
    if (fd_ >= 0) ::close(fd_);
}

Result<void> ScratchFile::write_at(uint64_t offset, std::span<const std::byte> data) {
    return write_all(fd_, offset, data, folder_ / "(temporary file)");
}
Result<void> ScratchFile::read_at(uint64_t offset, std::span<std::byte> out) const {
    return read_exactly(fd_, offset, out, folder_ / "(temporary file)");
}
void ScratchFile::discard(uint64_t offset, uint64_t bytes) {
    (void)::fallocate(fd_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                      static_cast<off_t>(bytes));
}

}  // namespace lucarne
