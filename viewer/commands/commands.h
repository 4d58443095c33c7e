#pragma once

#include <span>

#include "viewer/commands/arguments.h"

namespace lucarne::viewer {

/// Declares one command, its options and what it does.
using AddCommand = void (*)(CommandLine& line);

/// One function a command, each in a file of its own, in the order of the help.
std::span<const AddCommand> commands();

}  // namespace lucarne::viewer
