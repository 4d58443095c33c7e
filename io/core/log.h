#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace lucarne::log {

struct Said;

/// Messages for people, on stderr, one line each; results belong on stdout or into `--json`.
void info(std::string_view text);
void warn(std::string_view text);
void set_quiet(bool quiet);  ///< drops `info`, keeps `warn`

/// What warnings belong to: a command, or the opening of a scan with all that is done with it. The same
/// warning is said once in an operation, however often a file is read in it, and again in the next one.
/// Outside of all operations every warning is said. Copies are the same operation.
class Operation {
 public:
    Operation();
    /// The calling thread's, to be entered by another thread that works for it; of none, where it is in none.
    static Operation current();

    /// The calling thread's warnings belong to an operation while this lives.
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
