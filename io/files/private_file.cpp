#include "io/files/private_file.h"

#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/files/file_io.h"
#include "io/files/handle_pool.h"

namespace lucarne {
namespace {

using file_io::folder_of;
using file_io::reason;

constexpr const char* kAdvice = "remove it, or choose another folder";

/// Opens the folder. Its files are then reached through the handle, even if the folder's name changes.
Result<int> open_private_folder(const std::filesystem::path& folder) {
    const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0) {
        if (errno == ENOTDIR || errno == ELOOP)
            return failed(folder.string(), "is a link or not a folder", kAdvice);
        return failed(folder.string(), fmt::format("cannot be opened ({})", reason(errno)), kAdvice);
    }
    struct stat status {};
    const char* why = nullptr;
    if (::fstat(fd, &status) != 0 || status.st_uid != ::geteuid())
        why = "belongs to another user";
    else if (status.st_mode & (S_IWGRP | S_IWOTH))
        why = "can be written by other users";
    if (!why) return fd;
    ::close(fd);
    return failed(folder.string(), why, kAdvice);
}

}  // namespace

Result<void> make_private_folder(const std::filesystem::path& folder) {
    if (::mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST)
        return failed(folder.string(), fmt::format("cannot be made ({})", reason(errno)), kAdvice);
    LUCARNE_ASSIGN(const int fd, open_private_folder(folder));
    ::close(fd);
    return {};
}

Result<std::filesystem::path> new_private_folder(const std::filesystem::path& parent) {
    std::string name = (parent / ".lucarne-XXXXXX").string();
    if (!::mkdtemp(name.data()))
        return failed(parent.string(),
                      fmt::format("no temporary folder can be made here ({})", reason(errno)));
    return std::filesystem::path(name);
}

void remove_private_files(const std::filesystem::path& folder, std::span<const std::string> files) {
    const auto opened = open_private_folder(folder);
    if (!opened) return;
    const Handle handle(*opened);
    for (const std::string& file : files) ::unlinkat(handle.fd(), file.c_str(), 0);
}

void remove_private_folder(const std::filesystem::path& folder, std::span<const std::string> files) {
    remove_private_files(folder, files);
    ::rmdir(folder.c_str());  // fails if the folder holds anything else
}

Result<int> open_private_file(const std::filesystem::path& path, bool create) {
    LUCARNE_ASSIGN(const int opened, open_private_folder(folder_of(path)));
    const Handle folder(opened);
    const int fd = ::openat(folder.fd(), path.filename().c_str(),
                            O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | (create ? O_CREAT : 0), 0600);
    if (fd < 0) {
        if (errno == ELOOP) return failed(path.string(), "is a link", kAdvice);
        return failed(path.string(), fmt::format("cannot be opened ({})", reason(errno)));
    }
    struct stat status {};
    if (::fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == ::geteuid() &&
        status.st_nlink == 1)
        return fd;
    ::close(fd);
    return failed(path.string(), "is not a file of this user alone", kAdvice);
}

}  // namespace lucarne
