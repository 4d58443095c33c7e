#pragma once

#include <functional>
#include <string>

#include "io/core/error.h"
#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// Prints an error, with `who` behind it. Returns the exit code.
int report(const Error& error, const std::string& who = {});

struct Program {
    std::function<void(CommandLine&)> declare;  ///< declares the commands
    /// Takes the outcome of the command and returns that of the program.
    std::function<Result<void>(Result<void>)> conclude = [](Result<void> outcome) { return outcome; };
    std::string who{};  ///< printed behind errors
};

/// Runs the command that the arguments name. Prints errors. Returns the exit code.
int run_program(const Program& program, int argc, char** argv);

}  // namespace lucarne::viewer
