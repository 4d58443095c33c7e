#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/temporary_folder.h"

namespace lucarne::test {

/// Returns names of its files as text for commands.
class TemporaryFolder : public Folder {
 public:
    std::string operator/(const std::string& name) const { return (path() / name).string(); }
};

struct Outcome {
    int code = -1;
    std::string output;  ///< stdout and stderr
};

/// Runs a shell command.
inline Outcome shell(const std::string& command) {
    Outcome outcome;
    FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
    if (!pipe) return outcome;
    std::array<char, 4096> buffer{};
    for (size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        outcome.output.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

/// Runs the program under test.
inline Outcome lucarne(const std::string& arguments) {
    return shell(LUCARNE_BINARY " " + arguments);
}

inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A small Cornell box as a cache, made by the program itself.
inline std::string make_cornell(const TemporaryFolder& folder, const std::string& points = "60k") {
    const std::string scan = folder / "cornell.las", cache = folder / "cornell.luc";
    const Outcome generated = lucarne("generate cornell --points " + points + " -o " + scan);
    EXPECT_EQ(generated.code, 0) << generated.output;
    const Outcome converted = lucarne("convert " + scan + " -o " + cache);
    EXPECT_EQ(converted.code, 0) << converted.output;
    return cache;
}

}  // namespace lucarne::test
