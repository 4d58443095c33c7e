#pragma once

#include "io/formats/scan.h"
#include "viewer/commands/arguments.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {

/// Declares what a user may know better than a scan file. `options` outlives the command.
void add_read_options(Arguments& command, io::ReadOptions& options);
/// Declares INPUT..., --no-cache and the above. `options` outlives the command.
void add_input_options(Arguments& command, InputOptions& options);

}  // namespace lucarne::viewer
