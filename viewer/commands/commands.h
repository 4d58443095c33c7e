#pragma once

#include <functional>
#include <span>

#include "io/core/error.h"

namespace CLI {
class App;
}

namespace lucarne::viewer {

/// What the chosen command does; main runs it after the arguments are parsed.
using Command = std::function<Result<void>()>;
/// Declares one subcommand and its options; its callback sets `chosen`.
using AddCommand = void (*)(CLI::App& app, Command& chosen);

/// One function a command, each in a file of its own.
std::span<const AddCommand> commands();

}  // namespace lucarne::viewer
