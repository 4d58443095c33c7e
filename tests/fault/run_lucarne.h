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
inline Outcome lucarne(const std::string& arguments) {
    Outcome outcome;
    FILE* pipe = ::popen((std::string(LUCARNE_BINARY) + " " + arguments + " 2>&1").c_str(), "r");
    if (!pipe) return outcome;
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe)) outcome.text += buffer;
    const int status = ::pclose(pipe);
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    return outcome;
}

inline std::string quoted(const std::filesystem::path& path) {
    return "'" + path.string() + "'";
}

}  // namespace lucarne::test
