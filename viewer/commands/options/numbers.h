#pragma once

#include <string_view>
#include <vector>

#include "io/core/error.h"

namespace lucarne::viewer {

/// Parses `count` finite numbers separated by `between`, for example "1,2.5,-3". Errors (arguments) name the
/// option.
Result<std::vector<double>> parse_numbers(std::string_view option, std::string_view text, char between,
                                          size_t count);

}  // namespace lucarne::viewer
