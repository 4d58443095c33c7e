#pragma once

#include <span>

#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// Declares one command, its options and its action.
using AddCommand = void (*)(CommandLine& line);

/// All commands, in the order of the help. Each command is declared in its own file.
std::span<const AddCommand> commands();

}  // namespace lucarne::viewer
