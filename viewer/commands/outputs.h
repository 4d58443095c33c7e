#pragma once

#include <string>
#include <vector>

#include "io/core/error.h"

namespace lucarne::viewer {

/// Before any work of a command: that its outputs can be written (check_output; empty names are none), that
/// no two of them are one, and that none of them is one of its inputs, by whatever name, spelling or link.
Result<void> check_outputs(const std::vector<std::string>& outputs, bool overwrite,
                           const std::vector<std::string>& inputs);

}  // namespace lucarne::viewer
