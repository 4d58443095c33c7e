#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace lucarne::log {

struct Said;

/// Print a message for people on stderr, one line each. Results belong on stdout or into `--json` instead.
void info(std::string_view text);
void warn(std::string_view text);
void set_quiet(bool quiet);  ///< drops `info`, keeps `warn`

/// Groups warnings: an operation is a command, or the opening of a scan with everything that is done with it.
/// Within one operation the same warning is printed once, however often a file is read; the next operation
/// prints it again. Outside of all operations every warning is printed. A copy is the same operation.
class Operation {
 public:
    Operation();
    /// Returns the calling thread's operation, for another thread that works on its behalf to enter. Where
    /// the calling thread is in none, the result stands for "no operation".
    static Operation current();

    /// While this object lives, the calling thread's warnings belong to the operation.
    class Scope {
     public:
        explicit Scope(const Operation& operation);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

     private:
        std::shared_ptr<Said> before_;
    };

 private:
    explicit Operation(std::shared_ptr<Said> said) : said_(std::move(said)) {}
    std::shared_ptr<Said> said_;
};

template <class... Args>
requires(sizeof...(Args) > 0) void info(fmt::format_string<Args...> text, Args&&... args) {
    info(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}
template <class... Args>
requires(sizeof...(Args) > 0) void warn(fmt::format_string<Args...> text, Args&&... args) {
    warn(std::string_view(fmt::format(text, std::forward<Args>(args)...)));
}

}  // namespace lucarne::log
