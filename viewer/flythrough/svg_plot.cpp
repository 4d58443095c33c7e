#include "viewer/flythrough/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace lucarne::viewer {
namespace {

// Pixels. The plot scales with the page.
constexpr double kWidth = 860, kHeight = 260, kLeft = 64, kRight = 12, kTop = 34, kBottom = 40;
constexpr size_t kMostSteps = 400;  ///< horizontal steps of a curve with more values than this

// Okabe & Ito ("Color Universal Design", 2008): told apart with any colour vision.
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                 "#e69f00", "#56b4e9", "#8a6d3b", "#7f7f7f"};

std::string colour(size_t i) {
    return kColours[i % kColours.size()];
}

struct Axes {
    double x0 = 0, x1 = 1, y1 = 1;

    double x(double value) const { return kLeft + (value - x0) / (x1 - x0) * (kWidth - kLeft - kRight); }
    double y(double value) const { return kHeight - kBottom - value / y1 * (kHeight - kTop - kBottom); }
};

/// Keeps the least and the largest value of every step, in their order.
Curve thinned(const Curve& curve) {
    const size_t count = std::min(curve.x.size(), curve.y.size());
    if (count <= 2 * kMostSteps) return curve;
    Curve thin{curve.name, {}, {}};
    for (size_t step = 0; step < kMostSteps; ++step) {
        const auto first = curve.y.begin() + static_cast<std::ptrdiff_t>(step * count / kMostSteps);
        const auto last = curve.y.begin() + static_cast<std::ptrdiff_t>((step + 1) * count / kMostSteps);
        auto [least, most] = std::minmax_element(first, last);
        if (most < least) std::swap(least, most);
        for (const auto at : {least, most}) {
            thin.x.push_back(curve.x[static_cast<size_t>(at - curve.y.begin())]);
            thin.y.push_back(*at);
        }
    }
    return thin;
}

/// Formats a value with few digits: 0.25, 40, 12k, 3.5M.
std::string short_number(double value) {
    const double size = std::abs(value);
    if (size >= 1e9) return fmt::format("{:.3g}G", value / 1e9);
    if (size >= 1e6) return fmt::format("{:.3g}M", value / 1e6);
    if (size >= 1e4) return fmt::format("{:.3g}k", value / 1e3);
    return fmt::format("{:.4g}", value);
}

std::string grid(const Plot& plot, const Axes& axes) {
    std::string svg;
    for (const double tick : ticks_up_to(axes.y1)) {
        if (tick > axes.y1 * (1 + 1e-9)) continue;
        svg += fmt::format(R"(<line x1="{0}" x2="{1}" y1="{2:.1f}" y2="{2:.1f}" class="grid"/>)", kLeft,
                           kWidth - kRight, axes.y(tick));
        svg += fmt::format(R"(<text x="{}" y="{:.1f}" text-anchor="end">{}</text>)", kLeft - 6,
                           axes.y(tick) + 4, short_number(tick));
    }
    for (const double tick : ticks_up_to(axes.x1 - axes.x0, 10)) {
        if (axes.x0 + tick > axes.x1 * (1 + 1e-9)) continue;
        svg += fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{}</text>)",
                           axes.x(axes.x0 + tick), kHeight - kBottom + 16, short_number(axes.x0 + tick));
    }
    svg += fmt::format(R"(<text x="{}" y="{}" text-anchor="end">{}</text>)", kWidth - kRight, kHeight - 6,
                       escaped(plot.x_label));
    svg += fmt::format(R"(<text x="4" y="16" class="title">{}</text>)",
                       escaped(plot.title + ", " + plot.y_label));
    return svg;
}

std::string legend(const Plot& plot) {
    std::string svg;
    double x = kWidth - kRight;
    for (size_t i = plot.curves.size(); i-- > 0;) {
        x -= 7.0 * static_cast<double>(plot.curves[i].name.size()) + 26;
        svg += fmt::format(
            R"(<rect x="{:.0f}" y="7" width="12" height="10" fill="{}"/><text x="{:.0f}" y="16">{}</text>)",
            x, colour(i), x + 16, escaped(plot.curves[i].name));
    }
    return svg;
}

std::string lines(const Plot& plot, const Axes& axes) {
    std::string svg;
    for (size_t i = 0; i < plot.curves.size(); ++i) {
        const Curve curve = thinned(plot.curves[i]);
        std::string points;
        for (size_t k = 0; k < curve.x.size(); ++k)
            points += fmt::format("{:.1f},{:.1f} ", axes.x(curve.x[k]), axes.y(curve.y[k]));
        svg += fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.4"/>)", points,
                           colour(i));
    }
    return svg;
}

/// Draws from the top of the stack down: each area is drawn completely and covered by the areas below it.
std::string areas(const Plot& plot, const Axes& axes) {
    std::string svg;
    std::vector<double> top(plot.curves.front().x.size(), 0.0);
    for (size_t i = 0; i < plot.curves.size(); ++i) {
        const Curve& curve = plot.curves[i];
        for (size_t k = 0; k < top.size(); ++k) top[k] += curve.y[k];
        const Curve outline = thinned({"", curve.x, top});
        std::string points = fmt::format("{:.1f},{:.1f} ", axes.x(outline.x.front()), axes.y(0));
        for (size_t k = 0; k < outline.x.size(); ++k)
            points += fmt::format("{:.1f},{:.1f} ", axes.x(outline.x[k]), axes.y(outline.y[k]));
        points += fmt::format("{:.1f},{:.1f}", axes.x(outline.x.back()), axes.y(0));
        svg.insert(0, fmt::format(R"(<polygon points="{}" fill="{}"/>)", points, colour(i)));
    }
    return svg;
}

Axes axes_of(const Plot& plot) {
    Axes axes;
    double x0 = 1e300, x1 = -1e300, y1 = 0;
    std::vector<double> stack;
    for (const Curve& curve : plot.curves) {
        stack.resize(std::max(stack.size(), curve.y.size()), 0.0);
        for (size_t k = 0; k < curve.y.size(); ++k) {
            stack[k] = plot.stacked ? stack[k] + curve.y[k] : curve.y[k];
            y1 = std::max(y1, stack[k]);
        }
        for (const double x : curve.x) {
            x0 = std::min(x0, x);
            x1 = std::max(x1, x);
        }
    }
    if (x0 > 0 && x0 < 0.05 * x1) x0 = 0;  // the clock started slightly late
    if (x0 <= x1) axes = {x0, x1 > x0 ? x1 : x0 + 1, 1};
    axes.y1 = y1 > 0 ? y1 * 1.04 : 1;
    return axes;
}

}  // namespace

std::vector<double> ticks_up_to(double largest, size_t most) {
    if (!(largest > 0) || !std::isfinite(largest) || most < 2) return {0};
    const double rough = largest / static_cast<double>(most);
    const double power = std::pow(10, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double factor : {5.0, 2.0, 1.0})
        if (factor * power >= rough * (1 - 1e-9)) step = factor * power;
    std::vector<double> ticks;
    for (size_t i = 0; i == 0 || ticks.back() < largest * (1 - 1e-9); ++i)
        ticks.push_back(static_cast<double>(i) * step);
    return ticks;
}

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            case '\'':
                safe += "&#39;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

std::string svg_of(const Plot& plot) {
    const Axes axes = axes_of(plot);
    std::string svg = fmt::format(R"(<svg viewBox="0 0 {} {}" role="img">)", kWidth, kHeight);
    if (plot.stacked && !plot.curves.empty() && !plot.curves.front().x.empty()) svg += areas(plot, axes);
    svg += grid(plot, axes);
    if (!plot.stacked) svg += lines(plot, axes);
    return svg + legend(plot) + "</svg>\n";
}

}  // namespace lucarne::viewer
