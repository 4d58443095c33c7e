#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include <sys/wait.h>

// The program as a user runs it.
namespace lucarne::test {

struct Outcome {
    int code = -1;
    std::string text;  ///< stderr and stdout
};
/// `before`: a command of the shell, such as "ulimit -f 1; ".
inline Outcome lucarne(const std::string& arguments, const std::string& before = {}) {
    Outcome outcome;
    FILE* pipe = ::popen((before + LUCARNE_BINARY + " " + arguments + " 2>&1").c_str(), "r");
    if (!pipe) return outcome;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe)) outcome.text += buffer;
    const int status = ::pclose(pipe);
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    return outcome;
}

/// The same with files that fail, as fault/preload/faults.cpp has it; `code` is -1 where it was killed.
inline Outcome lucarne_with_fault(const std::string& fault, const std::string& arguments) {
    Outcome outcome;
    // The sanitizers' library wants to be the first, but does not need to.
    const std::string command = "ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" LUCARNE_FAULTS
                                "' LUCARNE_FAULT='" +
                                fault + "' exec " LUCARNE_BINARY " " + arguments + " 2>&1";
    FILE* pipe = ::popen(command.c_str(), "r");
    if (!pipe) return outcome;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe)) outcome.text += buffer;
    const int status = ::pclose(pipe);
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    return outcome;
}

inline std::string quoted(const std::filesystem::path& path) {
    std::string name = "'";  // added to piece by piece: g++ 12 warns of the sum of two temporaries
    name += path.string();
    return name += '\'';
}

}  // namespace lucarne::test
