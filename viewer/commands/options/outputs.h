#pragma once

#include <string>
#include <vector>

#include "io/core/error.h"

namespace lucarne::viewer {

/// Checks a command's outputs before any work. Errors: an output cannot be written (check_output); two
/// outputs are the same file; an output is one of the inputs, by whatever name, spelling or link. Empty names
/// are skipped.
Result<void> check_outputs(const std::vector<std::string>& outputs, bool overwrite,
                           const std::vector<std::string>& inputs);

}  // namespace lucarne::viewer
