#pragma once

#include <optional>
#include <string_view>

namespace lucarne::io {

/// Returns the length in metres of a unit that people name in headers and options: "mm", "US ft", "feet",
/// "us-ft"... Case, blanks and punctuation do not matter. Empty if the name is not known.
std::optional<double> metres_of_name(std::string_view name);

}  // namespace lucarne::io
