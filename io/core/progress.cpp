#include "io/core/progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "io/core/terminal.h"

namespace lucarne {
namespace {

constexpr double kSteadySeconds = 2, kSteadyShare = 0.01;  ///< before them there is no estimate

std::atomic<bool>& silent_flag() {
    static std::atomic<bool> flag{false};
    return flag;
}

std::string count_text(double n) {
    if (n >= 1e9) return fmt::format("{:.2f}G", n / 1e9);
    if (n >= 1e6) return fmt::format("{:.1f}M", n / 1e6);
    if (n >= 1e4) return fmt::format("{:.0f}k", n / 1e3);
    return fmt::format("{:.0f}", n);
}

}  // namespace

Progress::Progress(std::string label, uint64_t total, std::string unit)
    : label_(shown(label)),
      unit_(std::move(unit)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      terminal_(isatty(STDERR_FILENO) == 1) {
    next_print_ms_ = terminal_ ? 100 : 10'000;
}

Progress::~Progress() {
    print(true);
}

void Progress::set_silent(bool silent) {
    silent_flag() = silent;
}

double Progress::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::add(uint64_t amount) {
    done_ += amount;
    const auto now = static_cast<int64_t>(seconds() * 1000);
    int64_t due = next_print_ms_.load();
    if (now < due || !next_print_ms_.compare_exchange_strong(due, now + (terminal_ ? 100 : 10'000))) return;
    print(false);
}

void Progress::print(bool last) {
    if (silent_flag()) return;
    const std::lock_guard lock(print_mutex_);
    const double elapsed = std::max(seconds(), 1e-6);
    const auto done = static_cast<double>(done_.load());
    const double rate = done / elapsed;
    const char *start = terminal_ ? "\r" : "", *end = terminal_ ? "\x1b[K" : "\n";
    std::string line;
    if (last) {
        line = fmt::format("{}lucarne: {}: {} {} in {:.1f} s ({}/s){}\n", start, label_, count_text(done),
                           unit_, elapsed, count_text(rate), terminal_ ? end : "");
    } else if (total_ == 0) {
        line = fmt::format("{}lucarne: {}: {} {}, {}/s{}", start, label_, count_text(done), unit_,
                           count_text(rate), end);
    } else {
        const double share = std::min(1.0, done / static_cast<double>(total_));
        const double left = rate > 0 ? (static_cast<double>(total_) - done) / rate : 0;
        // A rate of the first moments says nothing about the rest.
        const std::string pace =
            elapsed >= kSteadySeconds && share >= kSteadyShare
                ? fmt::format(", {} {}/s, {:.0f} s left", count_text(rate), unit_, std::max(0.0, left))
                : std::string();
        const auto filled = static_cast<size_t>(share * 20);
        const std::string bar =
            terminal_ ? fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", 20 - filled) : "";
        line = fmt::format("{}lucarne: {}: {}{:.0f} %{}{}", start, label_, bar, share * 100, pace, end);
    }
    // fmt::print would throw if stderr cannot be written (a log on a full disk), and that must not stop the
    // work.
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
}

void Progress::end_line() {
    if (isatty(STDERR_FILENO)) std::fputc('\n', stderr);
}

}  // namespace lucarne
