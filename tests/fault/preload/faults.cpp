// A library for LD_PRELOAD. It counts the program's calls that change files or folders; the end of the
// program counts as the last call. At one of them it does what a disk, a signal or a power cut would do.
// LUCARNE_FAULT selects it:
//
//   count:FILE       does nothing; writes the number of calls to FILE at the end
//   trace:FILE       does nothing; writes the calls' names to FILE at the end, one a line
//   kill:N           sends SIGKILL before the N-th call (from 1)
//   kill-sync:N[:M]  sends SIGKILL before the N-th fsync, whose number does not depend on the order of
//                    threads; or before the M-th call behind it
//   signal:N:NUMBER  sends signal NUMBER before the N-th call, which happens only if the signal is ignored
//   full:N           every write from the N-th call on fails with ENOSPC
//   error:N[:ERRNO]  only the N-th call fails, with ERRNO (default: 5, EIO), unless it frees space
//   power:N:SEED     cuts the power before the N-th call, see below
//   run-write:N      runs the shell command $LUCARNE_FAULT_COMMAND before the N-th pwrite, which then goes on
//
// A power cut loses or keeps by chance every sector of 512 bytes that was written since its file's last sync,
// and so a file's growth. Of the names given since their folder's last sync, it loses the newest ones. Then
// it sends SIGKILL.
//
// LUCARNE_NO_TMPFILE: files cannot be made without a name.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// The old contents that an unsynced call replaced.
struct Undo {
    int fd = -1;
    dev_t device = 0;
    ino_t inode = 0;
    off_t offset = 0, size_before = 0;
    std::vector<char> before;
};

/// A name that was given since its folder's last sync.
struct UndoName {
    std::string name, from;  ///< `from`: the name before a rename, or empty
    std::string replaced;    ///< the name under which the replaced file is kept, if there was one
};

enum class Call { write, commit, cleanup };  ///< cleanup frees space and does not fail

class Faults {
 public:
    static Faults& instance() {
        static auto* faults = new Faults;  // never destroyed, because destructors write files as well
        return *faults;
    }

    /// Called before each call that changes a file. Returns 0, or the errno with which the call must fail.
    int enter(const char* name, Call call) {
        ++calls_;
        if (kind_ == "trace") trace_ += std::string(name) + '\n';
        if (kind_ == "kill-sync") {
            syncs_ += std::string(name) == "fsync" ? 1 : 0;
            if (syncs_ == at_ && behind_sync_++ == seed_) ::kill(::getpid(), SIGKILL);
            return 0;
        }
        if (kind_ == "run-write" && std::string(name) == "pwrite" && ++writes_ == at_) run();
        if (kind_ == "full" && calls_ >= at_ && call == Call::write) return ENOSPC;
        if (calls_ != at_) return 0;
        if (kind_ == "error" && call != Call::cleanup) return seed_ ? static_cast<int>(seed_) : EIO;
        if (kind_ == "signal") {
            struct sigaction action {};
            ::sigaction(static_cast<int>(seed_), nullptr, &action);
            ::kill(::getpid(), static_cast<int>(seed_));
            if (action.sa_handler == SIG_IGN) return 0;
            mutex_.unlock();  // so that other threads can clean up
            for (;;) ::pause();
        }
        if (kind_ == "power") lose();
        if (kind_ == "power" || kind_ == "kill") ::kill(::getpid(), SIGKILL);
        return 0;
    }
    /// Keeps the old contents of `bytes` from `offset` on, which are about to change.
    void remember(int fd, off_t offset, size_t bytes) {
        struct stat status {};
        if (kind_ != "power" || ::fstat(fd, &status) != 0) return;
        Undo undo{
            ::fcntl(fd, F_DUPFD_CLOEXEC, 200), status.st_dev, status.st_ino, offset, status.st_size, {}};
        undo.before.resize(bytes);
        const ssize_t got = ::pread(fd, undo.before.data(), bytes, offset);
        undo.before.resize(got > 0 ? static_cast<size_t>(got) : 0);
        undos_.push_back(std::move(undo));
    }
    void synced(int fd) {
        struct stat status {};
        if (kind_ != "power" || ::fstat(fd, &status) != 0) return;
        std::erase_if(undos_, [&](const Undo& undo) {
            const bool same = undo.device == status.st_dev && undo.inode == status.st_ino;
            if (same) ::close(undo.fd);
            return same;
        });
    }
    /// Keeps the file `name` before it is replaced. Returns the name under which it is kept.
    std::string keep(const std::string& name) {
        static const auto link = next<int(int, const char*, int, const char*, int)>("linkat");
        if (kind_ != "power") return {};
        std::string kept = name + ".undo-" + std::to_string(undo_names_.size());
        return link(AT_FDCWD, name.c_str(), AT_FDCWD, kept.c_str(), 0) == 0 ? kept : "";
    }
    void named(UndoName undo) {
        if (kind_ == "power") undo_names_.push_back(std::move(undo));
    }
    /// Forgets the names to undo. All names are in one folder.
    void folder_synced() {
        for (const UndoName& undo : undo_names_)
            if (!undo.replaced.empty()) next<int(const char*)>("unlink")(undo.replaced.c_str());
        undo_names_.clear();
    }
    void report() const {
        if (kind_ != "count" && kind_ != "trace") return;
        if (FILE* file = std::fopen(argument_.c_str(), "w")) {
            if (kind_ == "count")
                std::fprintf(file, "%llu\n", static_cast<unsigned long long>(calls_));
            else
                std::fputs(trace_.c_str(), file);
            std::fclose(file);
        }
    }
    std::recursive_mutex& mutex() { return mutex_; }

 private:
    Faults() {
        const char* text = std::getenv("LUCARNE_FAULT");
        const std::string fault = text ? text : "";
        const size_t colon = fault.find(':');
        kind_ = fault.substr(0, colon);
        if (colon != fault.npos) argument_ = fault.substr(colon + 1);
        if (kind_ != "count" && kind_ != "trace") std::sscanf(argument_.c_str(), "%llu:%llu", &at_, &seed_);
    }

    /// Ends the program if the command fails.
    static void run() {
        const char* command = std::getenv("LUCARNE_FAULT_COMMAND");
        ::unsetenv("LD_PRELOAD");  // the command is to have no faults
        if (!command || std::system(command) != 0) ::kill(::getpid(), SIGKILL);
    }

    void lose() {
        const auto write_back = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
        const auto cut = next<int(int, off_t)>("ftruncate");
        std::mt19937_64 random(seed_);
        lose_names(random() % (undo_names_.size() + 1));
        constexpr size_t kSector = 512;
        for (auto undo = undos_.rbegin(); undo != undos_.rend(); ++undo) {
            for (size_t at = 0; at < undo->before.size(); at += kSector)
                if (random() & 1)
                    (void)!write_back(undo->fd, &undo->before[at],
                                      std::min(kSector, undo->before.size() - at),
                                      undo->offset + static_cast<off_t>(at));
            struct stat status {};
            if (::fstat(undo->fd, &status) != 0 || status.st_size <= undo->size_before) continue;
            if (random() & 1) (void)!cut(undo->fd, undo->size_before);
            // Growth that stays may be a length without data.
            const std::vector<char> zeros(kSector);
            for (off_t at = undo->size_before; ::fstat(undo->fd, &status) == 0 && at < status.st_size;
                 at += static_cast<off_t>(kSector))
                if (random() & 1)
                    (void)!write_back(undo->fd, zeros.data(),
                                      std::min(kSector, static_cast<size_t>(status.st_size - at)), at);
        }
    }

    /// Undoes the newest names, because a file system records names in order.
    void lose_names(size_t count) {
        const auto move = next<int(const char*, const char*)>("rename");
        const auto remove = next<int(const char*)>("unlink");
        for (size_t i = 0; i < undo_names_.size(); ++i) {
            const UndoName& undo = undo_names_[undo_names_.size() - 1 - i];
            if (i >= count) {
                if (!undo.replaced.empty()) remove(undo.replaced.c_str());
                continue;
            }
            if (undo.from.empty())
                remove(undo.name.c_str());
            else
                move(undo.name.c_str(), undo.from.c_str());
            if (!undo.replaced.empty()) move(undo.replaced.c_str(), undo.name.c_str());
        }
    }

    std::recursive_mutex mutex_;
    std::string kind_, argument_, trace_;
    unsigned long long at_ = 0, seed_ = 0, calls_ = 0, syncs_ = 0, behind_sync_ = 0,
                       writes_ = 0;  ///< `seed_`: the second number, whatever it means
    std::vector<Undo> undos_;
    std::vector<UndoName> undo_names_;
};

struct AtEnd {
    ~AtEnd() {
        auto& faults = Faults::instance();
        const std::lock_guard lock(faults.mutex());
        (void)faults.enter("exit", Call::cleanup);
        faults.report();
    }
} at_end;

bool is_regular(int fd) {
    struct stat status {};
    return ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

template <class Make>
auto changing(const char* name, Call kind, const Make& make) -> decltype(make(Faults::instance())) {
    auto& faults = Faults::instance();
    const std::lock_guard lock(faults.mutex());
    if (const int error = faults.enter(name, kind)) {
        errno = error;
        return -1;
    }
    return make(faults);
}

int open_file(const char* path, int flags, mode_t mode) {
    static const auto real = next<int(const char*, int, ...)>("open");
    static const bool nameless = !std::getenv("LUCARNE_NO_TMPFILE");
    if (nameless || (flags & O_TMPFILE) != O_TMPFILE) return real(path, flags, mode);
    errno = EOPNOTSUPP;
    return -1;
}

}  // namespace

extern "C" {

ssize_t pwrite(int fd, const void* data, size_t bytes, off_t offset) {
    static const auto real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
    if (!is_regular(fd)) return real(fd, data, bytes, offset);
    return changing("pwrite", Call::write, [&](Faults& faults) {
        faults.remember(fd, offset, bytes);
        return real(fd, data, bytes, offset);
    });
}
ssize_t pwrite64(int fd, const void* data, size_t bytes, off64_t offset) {
    return pwrite(fd, data, bytes, offset);
}

int ftruncate(int fd, off_t size) noexcept {
    static const auto real = next<int(int, off_t)>("ftruncate");
    return changing("ftruncate", Call::write, [&](Faults& faults) {
        struct stat status {};
        if (::fstat(fd, &status) == 0 && status.st_size > size)
            faults.remember(fd, size, static_cast<size_t>(status.st_size - size));
        return real(fd, size);
    });
}
int ftruncate64(int fd, off64_t size) noexcept {
    return ftruncate(fd, size);
}

int fsync(int fd) {
    static const auto real = next<int(int)>("fsync");
    return changing("fsync", Call::commit, [&](Faults& faults) {
        struct stat status {};
        if (::fstat(fd, &status) == 0 && S_ISDIR(status.st_mode)) faults.folder_synced();
        faults.synced(fd);
        return real(fd);
    });
}

int linkat(int from, const char* old_name, int to, const char* new_name, int flags) noexcept {
    static const auto real = next<int(int, const char*, int, const char*, int)>("linkat");
    return changing("linkat", Call::commit, [&](Faults& faults) {
        const int done = real(from, old_name, to, new_name, flags);
        if (done == 0) faults.named({new_name, "", ""});
        return done;
    });
}

int rename(const char* from, const char* to) noexcept {
    static const auto real = next<int(const char*, const char*)>("rename");
    return changing("rename", Call::commit, [&](Faults& faults) {
        const std::string replaced = faults.keep(to);
        const int done = real(from, to);
        if (done == 0) faults.named({to, from, replaced});
        return done;
    });
}

int mkdir(const char* path, mode_t mode) noexcept {
    static const auto real = next<int(const char*, mode_t)>("mkdir");
    return changing("mkdir", Call::commit, [&](Faults&) { return real(path, mode); });
}

int unlink(const char* path) noexcept {
    static const auto real = next<int(const char*)>("unlink");
    return changing("unlink", Call::cleanup, [&](Faults&) { return real(path); });
}
int unlinkat(int folder, const char* path, int flags) noexcept {
    static const auto real = next<int(int, const char*, int)>("unlinkat");
    return changing("unlinkat", Call::cleanup, [&](Faults&) { return real(folder, path, flags); });
}
int rmdir(const char* path) noexcept {
    static const auto real = next<int(const char*)>("rmdir");
    return changing("rmdir", Call::cleanup, [&](Faults&) { return real(path); });
}
int fallocate(int fd, int mode, off_t offset, off_t bytes) {
    static const auto real = next<int(int, int, off_t, off_t)>("fallocate");
    return changing("fallocate", Call::cleanup, [&](Faults&) { return real(fd, mode, offset, bytes); });
}
int fallocate64(int fd, int mode, off64_t offset, off64_t bytes) {
    return fallocate(fd, mode, offset, bytes);
}

int open(const char* path, int flags, ...) {
    std::va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open_file(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    std::va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open_file(path, flags, mode);
}

}  // extern "C"
