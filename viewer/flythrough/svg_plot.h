#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lucarne::viewer {

/// One curve: y over increasing x.
struct Curve {
    std::string name;
    std::vector<double> x, y;
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<Curve> curves;
    bool stacked = false;  ///< draw stacked areas instead of lines; the curves must share their x
};

/// Returns the plot as an <svg> element that takes text and grid colours from the page's currentColor. A
/// curve with many values is drawn by the least and the largest value in each of some hundred steps, so that
/// no spike is lost and the page stays small.
std::string svg_of(const Plot& plot);

/// Returns at most `most` ticks from 0 to at least `largest`; their step is 1, 2 or 5 times a power of ten.
std::vector<double> ticks_up_to(double largest, size_t most = 6);

/// Returns the text with HTML's special characters escaped.
std::string escaped(std::string_view text);

}  // namespace lucarne::viewer
