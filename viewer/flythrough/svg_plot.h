#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lucarne::viewer {

/// One curve: y over x, x growing.
struct Curve {
    std::string name;
    std::vector<double> x, y;
};

struct Plot {
    std::string title, x_label, y_label;
    std::vector<Curve> curves;
    bool stacked = false;  ///< areas on top of each other instead of lines; the curves share their x
};

/// The plot as an <svg> element that takes its text and grid colours from the page's currentColor. Curves of
/// many values are drawn by the least and the largest in each of some hundred steps, so that no spike is lost
/// and the page stays small.
std::string svg_of(const Plot& plot);

/// Ticks at 1, 2 or 5 times a power of ten, `most` of them or fewer, from 0 to at least `largest`.
std::vector<double> ticks_up_to(double largest, size_t most = 6);

/// The text without anything that HTML would take for markup.
std::string escaped(std::string_view text);

}  // namespace lucarne::viewer
