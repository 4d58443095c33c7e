// Marks along axes, legends and rulers.
#pragma once

#include <string>
#include <vector>

namespace lucarne::viewer {

/// The largest 1, 2 or 5 times a power of ten that is at most `most`; 0 where that is no positive number.
double nice_at_most(double most);
/// 1, 2 or 5 times a power of ten: the step of at most `count` marks over a range.
double axis_step(double range, int count);
/// The multiples of the step from `low` to `high`, to a billionth of a step; a hundred at most.
std::vector<double> axis_marks(double low, double high, double step);
/// At most `count` + 1 marks from `low` to `high`; none where that is not above `low`.
std::vector<double> nice_marks(double low, double high, int count);
/// A mark of such an axis: as many decimals as the step has, and no minus before 0.
std::string axis_text(double value, double step);

}  // namespace lucarne::viewer
