#pragma once

#include "io/formats/scan.h"
#include "viewer/commands/options/arguments.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {

/// Declares options by which the user overrides what a scan file says. `options` must outlive the command.
void add_read_options(Arguments& command, io::ReadOptions& options);
/// Declares INPUT..., --no-cache and the options of add_read_options(). `options` must outlive the command.
void add_input_options(Arguments& command, InputOptions& options);

}  // namespace lucarne::viewer
