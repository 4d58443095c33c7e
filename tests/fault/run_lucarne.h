#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <sys/wait.h>

// The program as a user runs it.
namespace lucarne::test {

struct Outcome {
    int code = -1;     ///< -1 where a signal ended it
    int signal = 0;    ///< which one
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

/// `before`: a command of the shell, such as "ulimit -f 1; ".
inline Outcome lucarne(const std::string& arguments, const std::string& before = {}) {
    return run(before + LUCARNE_BINARY + " " + arguments);
}

/// The same with files that fail, as fault/preload/faults.cpp has it. `before`: variables of the environment.
inline Outcome lucarne_with_fault(const std::string& fault, const std::string& arguments,
                                  const std::string& before = {}) {
    // The sanitizers' library wants to be the first, but does not need to.
    return run(before + " ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" LUCARNE_FAULTS "' LUCARNE_FAULT='" +
               fault + "' exec " LUCARNE_BINARY " " + arguments);
}

inline std::string quoted(const std::filesystem::path& path) {
    std::string name = "'";  // added to piece by piece: g++ 12 warns of the sum of two temporaries
    name += path.string();
    return name += '\'';
}

}  // namespace lucarne::test
