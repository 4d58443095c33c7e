#include "viewer/overlay/axis_marks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace lucarne::viewer {

double nice_at_most(double most) {
    if (!(most > 0) || !std::isfinite(most)) return 0;
    const double power = std::pow(10.0, std::floor(std::log10(most)));
    for (const double factor : {5.0, 2.0, 1.0})
        if (factor * power <= most * (1 + 1e-12)) return factor * power;
    return power / 2;  // rounding made the logarithm too large
}

double axis_step(double range, int count) {
    const double least = (range > 0 ? range : 1e-9) / count;
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least * (1 - 1e-9)) return factor * power;
    return 10 * power;
}

std::vector<double> axis_marks(double low, double high, double step) {
    std::vector<double> marks;
    const double first = std::ceil(low / step - 1e-9);
    // Count the marks: at large values a step may be smaller than the resolution of a double.
    for (int i = 0; i < 100 && (first + i) * step <= high + 1e-9 * step; ++i)
        marks.push_back((first + i) * step);
    return marks;
}

std::vector<double> nice_marks(double low, double high, int count) {
    if (!(high > low)) return {};
    return axis_marks(low, high, axis_step(high - low, count));
}

std::string axis_text(double value, double step) {
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
    return fmt::format("{:.{}f}", std::abs(value) < step / 2 ? 0.0 : value, decimals);
}

}  // namespace lucarne::viewer
