#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace lucarne {

/// Shows the progress of one long stage on stderr. On a terminal it is a bar with the rate and the time left;
/// elsewhere it is a plain line every 10 s and at the end. Thread-safe. `add` is cheap enough to be called
/// per batch, not per point.
class Progress {
 public:
    /// `total` 0 means unknown. `unit` names what is counted ("points").
    Progress(std::string label, uint64_t total, std::string unit);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void add(uint64_t amount);
    double seconds() const;  ///< since construction

    /// Turns all output off, for tests and `--quiet`.
    static void set_silent(bool silent);
    /// Moves the cursor below a bar that may be on the terminal. An interrupt calls it before it prints a
    /// last line.
    static void end_line();

 private:
    void print(bool last);

    std::string label_, unit_;
    uint64_t total_;
    std::atomic<uint64_t> done_{0};
    std::atomic<int64_t> next_print_ms_;
    std::chrono::steady_clock::time_point start_;
    bool terminal_;
    std::mutex print_mutex_;
};

}  // namespace lucarne
