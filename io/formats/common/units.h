#pragma once

#include <optional>
#include <string_view>

namespace lucarne::io {

/// The international foot and that of US surveys, metres. They differ by 2e-6.
inline constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;

/// Returns the length in metres of a unit that people name in headers and options: "mm", "US ft", "feet",
/// "us-ft"... Case, blanks and punctuation do not matter. Empty if the name is not known.
std::optional<double> metres_of_name(std::string_view name);

}  // namespace lucarne::io
