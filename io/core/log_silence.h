#pragma once

namespace lucarne::log {

/// Drops all messages (log.h), for one of several processes that would all say the same.
void set_silent(bool silent);

/// Lets a silent process speak while this object lives, because no other one says the same.
class Speaking {
 public:
    explicit Speaking(bool silent) : silent_(silent) {
        if (silent_) set_silent(false);
    }
    ~Speaking() {
        if (silent_) set_silent(true);
    }
    Speaking(const Speaking&) = delete;
    Speaking& operator=(const Speaking&) = delete;

 private:
    bool silent_;
};

/// Drops the calling thread's warnings while this object lives, because they were printed before, perhaps by
/// another process.
class Hush {
 public:
    Hush();
    ~Hush();
    Hush(const Hush&) = delete;
    Hush& operator=(const Hush&) = delete;

 private:
    bool before_;
};

}  // namespace lucarne::log
