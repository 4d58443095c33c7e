// A library that LD_PRELOAD puts between the program and the C library: it counts the calls that change files
// and, at one of them, does what a disk, a signal or a power cut would. LUCARNE_FAULT says what:
//
//   count:FILE       nothing; writes the number of calls to FILE at the end
//   kill:N           SIGKILL before the N-th call (from 1)
//   full:N           from the N-th call on, every write fails with ENOSPC
//   error:N[:ERRNO]  the N-th call alone fails with this errno, EIO (5) where none is given
//   power:N:SEED     before the N-th call the power goes: of what was written since each file's last sync
//   every
//                    sector of 512 bytes is lost or kept by chance, and so is a file's growth; then SIGKILL
#include <algorithm>
#include <cerrno>
#include <csignal>
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

/// What a call that is not synced yet replaced.
struct Undo {
    int fd = -1;
    dev_t device = 0;
    ino_t inode = 0;
    off_t offset = 0, size_before = 0;
    std::vector<char> before;
};

class Faults {
 public:
    static Faults& instance() {
        static auto* faults = new Faults;  // lives until the very end: files are written by destructors, too
        return *faults;
    }

    /// Called before each call that changes a file; a value other than 0 is the errno that it shall fail
    /// with.
    int enter(bool writes) {
        ++calls_;
        if (kind_ == "full" && calls_ >= at_ && writes) return ENOSPC;
        if (calls_ != at_) return 0;
        if (kind_ == "error") return seed_ ? static_cast<int>(seed_) : EIO;
        if (kind_ == "power") lose();
        if (kind_ == "power" || kind_ == "kill") ::kill(::getpid(), SIGKILL);
        return 0;
    }
    /// `bytes` from `offset` on are about to change.
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
    void report() const {
        if (kind_ != "count") return;
        if (FILE* file = std::fopen(argument_.c_str(), "w")) {
            std::fprintf(file, "%llu\n", static_cast<unsigned long long>(calls_));
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
        if (kind_ != "count") std::sscanf(argument_.c_str(), "%llu:%llu", &at_, &seed_);
    }

    void lose() {
        const auto write_back = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
        const auto cut = next<int(int, off_t)>("ftruncate");
        std::mt19937_64 random(seed_);
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
            // What stays of the growth may be there by its length alone.
            const std::vector<char> zeros(kSector);
            for (off_t at = undo->size_before; ::fstat(undo->fd, &status) == 0 && at < status.st_size;
                 at += static_cast<off_t>(kSector))
                if (random() & 1)
                    (void)!write_back(undo->fd, zeros.data(),
                                      std::min(kSector, static_cast<size_t>(status.st_size - at)), at);
        }
    }

    std::recursive_mutex mutex_;
    std::string kind_, argument_;
    unsigned long long at_ = 0, seed_ = 0, calls_ = 0;  ///< `seed_`: the number after the call's, whatever it means
    std::vector<Undo> undos_;
};

struct AtEnd {
    ~AtEnd() { Faults::instance().report(); }
} at_end;

bool is_regular(int fd) {
    struct stat status {};
    return ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
}

template <class Call>
auto changing(bool writes, const Call& call) -> decltype(call(Faults::instance())) {
    auto& faults = Faults::instance();
    const std::lock_guard lock(faults.mutex());
    if (const int error = faults.enter(writes)) {
        errno = error;
        return -1;
    }
    return call(faults);
}

}  // namespace

extern "C" {

ssize_t pwrite(int fd, const void* data, size_t bytes, off_t offset) {
    static const auto real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
    if (!is_regular(fd)) return real(fd, data, bytes, offset);
    return changing(true, [&](Faults& faults) {
        faults.remember(fd, offset, bytes);
        return real(fd, data, bytes, offset);
    });
}
ssize_t pwrite64(int fd, const void* data, size_t bytes, off64_t offset) {
    return pwrite(fd, data, bytes, offset);
}

int ftruncate(int fd, off_t size) noexcept {
    static const auto real = next<int(int, off_t)>("ftruncate");
    return changing(true, [&](Faults& faults) {
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
    return changing(false, [&](Faults& faults) {
        faults.synced(fd);
        return real(fd);
    });
}

int linkat(int from, const char* old_name, int to, const char* new_name, int flags) noexcept {
    static const auto real = next<int(int, const char*, int, const char*, int)>("linkat");
    return changing(false, [&](Faults&) { return real(from, old_name, to, new_name, flags); });
}

int rename(const char* from, const char* to) noexcept {
    static const auto real = next<int(const char*, const char*)>("rename");
    return changing(false, [&](Faults&) { return real(from, to); });
}

}  // extern "C"
