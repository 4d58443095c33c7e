#pragma once

#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// Declares one command, its options and its action.
using AddCommand = void (*)(CommandLine& line);

/// Declares all commands, in the order of the help. Each command is declared in its own file.
void add_commands(CommandLine& line);

}  // namespace lucarne::viewer
