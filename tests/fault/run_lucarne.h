#pragma once

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

// Runs the program as a user does.
namespace lucarne::test {

struct Outcome {
    int code = -1;     ///< exit code; -1 if a signal ended the program
    int signal = 0;    ///< that signal
    std::string text;  ///< stderr and stdout
};

inline Outcome run(const std::string& command) {
    Outcome outcome;
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (!pipe) return outcome;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe)) outcome.text += buffer;
    const int status = ::pclose(pipe);
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    return outcome;
}

/// Runs the program. `before`: a shell command such as "ulimit -f 1; ".
inline Outcome lucarne(const std::string& arguments, const std::string& before = {}) {
    return run(before + LUCARNE_BINARY + " " + arguments);
}

/// Runs the program with a fault of fault/preload/faults.cpp. `before`: environment variables.
inline Outcome lucarne_with_fault(const std::string& fault, const std::string& arguments,
                                  const std::string& before = {}) {
    // The sanitizers' library asks to be loaded first, but need not be.
    return run(before +
               " ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" LUCARNE_FAULTS "' LUCARNE_FAULT='" +
               fault + "' exec " LUCARNE_BINARY " " + arguments);
}

/// Returns the names of the calls that change files, in order, for a command that succeeds. The preloaded
/// library writes to the file `scratch`.
inline std::vector<std::string> traced_calls(const std::filesystem::path& scratch,
                                             const std::string& arguments, const std::string& before = {}) {
    const auto traced = lucarne_with_fault("trace:" + scratch.string(), arguments, before);
    EXPECT_EQ(traced.code, 0) << traced.text;
    std::ifstream lines(scratch);
    std::vector<std::string> calls;
    for (std::string call; std::getline(lines, call);) calls.push_back(call);
    return calls;
}
/// Returns the number of the last call of this name, counted from 1 as in faults, or 0 if there is none.
inline size_t last_call(const std::vector<std::string>& calls, const std::string& name) {
    return static_cast<size_t>(calls.rend() - std::find(calls.rbegin(), calls.rend(), name));
}

inline std::string quoted(const std::filesystem::path& path) {
    std::string name = "'";  // appended piece by piece, because g++ 12 warns of the sum of two temporaries
    name += path.string();
    return name += '\'';
}

}  // namespace lucarne::test
