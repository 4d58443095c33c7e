// What figures depend on beside the program and its arguments.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace lucarne::bench {

/// Returns the processor's name as Linux states it.
inline std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

/// Returns the revision of the source, with "-dirty" after it if files have changed since; "unknown" without
/// git.
inline std::string revision() {
    std::string text;
    if (FILE* git = popen("git -C '" LUCARNE_SOURCE_DIR "' describe --always --dirty 2>/dev/null", "r")) {
        for (int c = std::fgetc(git); c != EOF && c != '\n'; c = std::fgetc(git))
            text += static_cast<char>(c);
        pclose(git);
    }
    return text.empty() ? "unknown" : text;
}

/// Returns one line: revision, date, processor, hardware threads, and the load at the beginning, which tells
/// how far times can be trusted.
inline std::string circumstances() {
    double load[1] = {};
    if (getloadavg(load, 1) != 1) load[0] = -1;
    return fmt::format("revision {}, {:%Y-%m-%d}, {}, {} hardware threads, load {:.1f}", revision(),
                       fmt::gmtime(std::time(nullptr)), processor(), std::thread::hardware_concurrency(),
                       load[0]);
}

}  // namespace lucarne::bench
