// Positions and texts of marks along axes, legends and rulers.
#pragma once

#include <string>
#include <vector>

namespace lucarne::viewer {

/// Returns the largest 1, 2 or 5 times a power of ten that is at most `most`, or 0 if `most` is not a
/// positive number.
double nice_at_most(double most);
/// Returns the step of at most `count` marks over a range: 1, 2 or 5 times a power of ten.
double axis_step(double range, int count);
/// Returns the multiples of `step` from `low` to `high`, with a tolerance of a billionth of a step; at most a
/// hundred.
std::vector<double> axis_marks(double low, double high, double step);
/// Returns at most `count` + 1 marks from `low` to `high`; none if `high` is not above `low`.
std::vector<double> nice_marks(double low, double high, int count);
/// Returns the text of a mark, with as many decimals as the step needs and no minus sign before 0.
std::string axis_text(double value, double step);

}  // namespace lucarne::viewer
