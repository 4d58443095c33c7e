#pragma once

#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/core/error.h"

namespace lucarne {

struct Usage {
    double cpu_seconds = 0, peak_mebibytes = 0;
};

/// Runs `lucarne` with these arguments in a separate process, so that its memory can be measured.
inline Result<Usage> run_lucarne(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), LUCARNE_BINARY);
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child < 0) return failed("fork", "no new process");
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);  // an interrupted benchmark leaves no process behind
        execv(argv[0], argv.data());
        _exit(127);
    }
    int status = 0;
    rusage used{};
    wait4(child, &status, 0, &used);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return failed("lucarne " + arguments[1], fmt::format("ended with status {}", status));
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return Usage{seconds(used.ru_utime) + seconds(used.ru_stime), static_cast<double>(used.ru_maxrss) / 1024};
}

/// Prints a figure without a target.
inline void figure(const std::string& what, double value, const std::string& unit) {
    fmt::print("{:<68} {:>9.2f} {}\n", what, value, unit);
    std::fflush(stdout);
}
/// Prints why a figure is missing.
inline void row_missing(const std::string& what, const std::string& why) {
    fmt::print("{:<68} not measured: {}\n", what, why);
    std::fflush(stdout);
}
inline void print_row(const std::string& what, double value, const std::string& unit, double target,
                      bool kept) {
    fmt::print("{:<68} {:>9.2f} {:<7} target {:>7.1f}  {}\n", what, value, unit, target,
               kept ? "kept" : "MISSED");
    std::fflush(stdout);
}
/// Prints a figure that should be at most the target.
inline void row(const std::string& what, double value, const std::string& unit, double target) {
    print_row(what, value, unit, target, value <= target);
}
/// Prints a figure that should be at least the target.
inline void row_at_least(const std::string& what, double value, const std::string& unit, double target) {
    print_row(what, value, unit, target, value >= target);
}

}  // namespace lucarne
