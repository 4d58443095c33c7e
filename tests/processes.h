// Programs that tests and benchmarks run.
#pragma once

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lucarne::test {

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

/// Returns the contents of a file, for example of a program's log.
inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Ends a test that hangs; not a measurement. Long enough for a machine that has a tenth of its time for
/// tests.
inline constexpr auto kPatience = std::chrono::seconds(600);

inline bool installed(const std::string& program) {
    return shell("command -v " + program).code == 0;
}

/// Polls until `there` holds, with a pause after each look. Returns false after `patience`.
template <class Condition>
bool eventually(const Condition& there, std::chrono::milliseconds pause = std::chrono::milliseconds(100),
                std::chrono::seconds patience = kPatience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        if (there()) return true;
        std::this_thread::sleep_for(pause);
    }
    return false;
}

/// A background program that is ended together with this object.
class Background {
 public:
    explicit Background(const std::string& command) {
        pid_ = fork();
        if (pid_ == 0) {
            // The program ends with the one that started it, and takes signals that handle_interrupts() has
            // blocked there.
            prctl(PR_SET_PDEATHSIG, SIGTERM);
            sigset_t none;
            sigemptyset(&none);
            sigprocmask(SIG_SETMASK, &none, nullptr);
            execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
            _exit(127);
        }
    }
    ~Background() {
        if (!running()) return;
        kill(pid_, SIGTERM);
        if (eventually([&] { return !running(); })) return;
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool running() {
        int status = 0;
        if (pid_ > 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
            code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            pid_ = -1;
        }
        return pid_ > 0;
    }
    std::optional<int> code() const { return code_; }
    pid_t pid() const { return pid_; }  ///< -1 once it has ended

 private:
    pid_t pid_ = -1;
    std::optional<int> code_;
};

}  // namespace lucarne::test
