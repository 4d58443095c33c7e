#include "viewer/overlay/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "gi/scene/views.h"
#include "viewer/inputs/units.h"
#include "viewer/overlay/axis_marks.h"

namespace lucarne::viewer {
namespace {

using glm::dvec2;

constexpr glm::vec3 kInk(0.95f), kPaper(0.08f);
constexpr size_t kMostRows = 24;

class Sheet {
 public:
    explicit Sheet(const OverlayView& view) : view_(view) {}

    void line(const dvec2& from, const dvec2& to, const glm::vec3& colour = kInk) {
        marks.push_back({Mark::Kind::line, from, to, colour});
    }
    void area(const dvec2& from, const dvec2& to, const glm::vec3& colour, float opacity = 1) {
        marks.push_back({Mark::Kind::area, from, to, colour, opacity});
    }
    void text(const dvec2& at, std::string words, const glm::vec3& colour = kInk) {
        marks.push_back({Mark::Kind::text, at, at, colour, 1, std::move(words)});
    }
    double width() const { return view_.size.width - view_.right; }
    double height() const { return view_.size.height - view_.bottom; }
    double left() const { return view_.left; }
    double em() const { return view_.font; }

    std::vector<Mark> marks;

 private:
    const OverlayView& view_;
};

/// Draws a title and rows of a colour and a name at the top right.
void draw_rows(Sheet& sheet, const std::string& title,
               const std::vector<std::pair<glm::vec3, std::string>>& rows) {
    const double em = sheet.em(), left = sheet.width() - 14 * em, row = 1.3 * em;
    dvec2 at(left, 2.5 * em);
    sheet.area(at - dvec2(0.6 * em), at + dvec2(13.4 * em, (static_cast<double>(rows.size()) + 1.4) * row),
               kPaper, 0.6f);
    sheet.text(at, title);
    for (const auto& [colour, name] : rows) {
        at.y += row;
        sheet.area(at + dvec2(0, 0.1 * em), at + dvec2(1.2 * em, 1.0 * em), colour);
        sheet.text(at + dvec2(1.7 * em, 0), name);
    }
}

void draw_numbers(Sheet& sheet, const gi::Look& look, const gi::ShownValues& values) {
    std::vector<std::pair<glm::vec3, std::string>> rows;
    for (size_t number = 0; number < 256; ++number) {
        if (!values.numbers[number]) continue;
        const bool classes = look.colour == gi::ColourBy::classification;
        if (classes && look.hidden_classes[number]) continue;
        if (rows.size() == kMostRows) {
            rows.emplace_back(kPaper, "and more");
            break;
        }
        const auto small = static_cast<uint8_t>(number);
        rows.emplace_back(
            classes ? gi::class_colour(small) : gi::ordinal_colour(number),
            classes ? fmt::format("{} {}", number, gi::class_name(small)) : fmt::format("{}", number));
    }
    draw_rows(sheet, legend_title(look), rows);
}

LegendBar range_bar(const Sheet& sheet) {
    const double em = sheet.em(), length = std::min(18 * em, 0.6 * sheet.height());
    const dvec2 top(sheet.width() - 10 * em, 4 * em);
    return {top, top + dvec2(1.6 * em, length), top - dvec2(0.6 * em, 2.1 * em),
            top + dvec2(9.4 * em, length + 0.9 * em)};
}

void draw_range(Sheet& sheet, const gi::Look& look, const gi::ValueRange& range) {
    constexpr int kBands = 96;
    const LegendBar bar = range_bar(sheet);
    const double em = sheet.em(), length = bar.to.y - bar.from.y;
    const dvec2 top = bar.from;
    sheet.area(bar.paper_from, bar.paper_to, kPaper, 0.6f);
    sheet.text(top - dvec2(0, 1.6 * em), legend_title(look));
    for (int i = 0; i < kBands; ++i) {
        const double place = 1 - (i + 0.5) / kBands;
        const dvec2 from = top + dvec2(0, length * i / kBands);
        sheet.area(from, top + dvec2(1.6 * em, length * (i + 1) / kBands),
                   gi::mapped_colour(look.map, look.reversed ? 1 - place : place));
    }
    const double low = std::min(range.low, range.high), high = std::max(range.low, range.high);
    for (const double tick : nice_marks(low, high, 6)) {
        const double place = (tick - range.low) / (range.high - range.low);
        const double y = top.y + length * (1 - place);
        sheet.line({top.x + 1.6 * em, y}, {top.x + 2.1 * em, y});
        sheet.text({top.x + 2.5 * em, y - 0.5 * em}, fmt::format("{:.6g}", tick));
    }
}

void draw_legend(Sheet& sheet, const gi::Look& look, const gi::ShownValues& values) {
    switch (look.colour) {
        case gi::ColourBy::colour:
        case gi::ColourBy::clay:
            return;
        case gi::ColourBy::normal:
            return draw_rows(sheet, legend_title(look),
                             {{{1, .5f, .5f}, "+x"},
                              {{0, .5f, .5f}, "-x"},
                              {{.5f, 1, .5f}, "+y"},
                              {{.5f, 0, .5f}, "-y"},
                              {{.5f, .5f, 1}, "+z"},
                              {{.5f, .5f, 0}, "-z"}});
        case gi::ColourBy::classification:
        case gi::ColourBy::return_number:
        case gi::ColourBy::scan:
            return draw_numbers(sheet, look, values);
        case gi::ColourBy::intensity:
        case gi::ColourBy::elevation:
        case gi::ColourBy::attribute:
            if (values.range) draw_range(sheet, look, *values.range);
    }
}

/// Draws the axes at the bottom left, the farthest first.
void draw_axes(Sheet& sheet, const gi::SceneCamera& camera) {
    static constexpr std::array<glm::vec3, 3> kColours = {
        glm::vec3(0.95f, 0.3f, 0.3f), glm::vec3(0.4f, 0.85f, 0.35f), glm::vec3(0.4f, 0.6f, 1.0f)};
    static constexpr std::array kNames = {"x", "y", "z"};
    const double em = sheet.em(), length = 2.6 * em;
    const dvec2 middle(sheet.left() + 4 * em, sheet.height() - 4.5 * em);
    const auto axes = axes_in(camera);
    std::array<size_t, 3> order = {0, 1, 2};
    std::ranges::sort(order, [&](size_t a, size_t b) { return axes[a].depth > axes[b].depth; });
    for (const size_t i : order) {
        const dvec2 tip = middle + length * axes[i].place;
        sheet.line(middle, tip, kColours[i]);
        sheet.text(tip + 0.5 * em * axes[i].place - dvec2(0.25 * em, 0.5 * em), kNames[i], kColours[i]);
    }
}

void draw_scale(Sheet& sheet, const OverlayView& view) {
    const double em = sheet.em();
    const double pixel =
        2 * std::tan(view.camera.vertical_fov / 2) * view.distance / std::max(view.size.height, 1u);
    const auto bars = scale_bars(pixel, view.metres_per_unit, 0.25 * sheet.width());
    dvec2 at(sheet.left() + 8.5 * em, sheet.height() - (1.3 + 1.9 * static_cast<double>(bars.size())) * em);
    if (!bars.empty()) {
        const auto longer = [](const ScaleBar& a, const ScaleBar& b) { return a.pixels < b.pixels; };
        const double widest = std::ranges::max_element(bars, longer)->pixels;
        const double below = 1.9 * static_cast<double>(bars.size()) * em;
        sheet.area(at - dvec2(0.6 * em, 0.3 * em), at + dvec2(widest + 0.6 * em, below - 0.1 * em), kPaper,
                   0.6f);
    }
    for (const ScaleBar& bar : bars) {
        const dvec2 line = at + dvec2(0, 1.3 * em), end = line + dvec2(bar.pixels, 0), up(0, -0.4 * em);
        sheet.line(line, end);
        sheet.line(line, line + up);
        sheet.line(end, end + up);
        sheet.text(at + dvec2(0.4 * em, 0), bar.text);
        at.y += 1.9 * em;
    }
}

/// Returns a text such as "5 km" or "20 cm".
std::string metres_text(double metres) {
    if (metres >= 1000) return fmt::format("{:g} km", metres / 1000);
    if (metres >= 1) return fmt::format("{:g} m", metres);
    if (metres >= 0.01) return fmt::format("{:g} cm", metres * 100);
    return fmt::format("{:g} mm", metres * 1000);
}

}  // namespace

std::vector<ScaleBar> scale_bars(double pixel, double metres_per_unit, double most) {
    std::vector<ScaleBar> bars;
    const double units = nice_at_most(most * pixel);
    if (!(units > 0) || !(pixel > 0)) return bars;
    const std::string name = unit_name(metres_per_unit);
    bars.push_back({units / pixel, name == "m" ? metres_text(units) : fmt::format("{:g} {}", units, name)});
    if (name == "m") return bars;
    const double metres = nice_at_most(most * pixel * metres_per_unit);
    if (metres > 0) bars.push_back({metres / metres_per_unit / pixel, metres_text(metres)});
    return bars;
}

std::vector<Axis> axes_in(const gi::SceneCamera& camera) {
    const octree::View view = gi::octree_view(camera, {1, 1});
    std::vector<Axis> axes;
    for (int i = 0; i < 3; ++i) axes.push_back({{view.right[i], -view.up[i]}, view.forward[i]});
    return axes;
}

std::string legend_title(const gi::Look& look) {
    static constexpr std::array kTitles = {
        "Colour", "Intensity", "Elevation", "Classification", "Return number", "Scan", "Normal", "", "Clay"};
    if (look.colour == gi::ColourBy::attribute) return look.attribute;
    return kTitles[static_cast<size_t>(look.colour)];
}

std::optional<LegendBar> legend_bar(const gi::Look& look, const gi::ShownValues& values,
                                    const OverlayView& view) {
    if (!look.legend || !values.range || !gi::has_range(look.colour)) return std::nullopt;
    return range_bar(Sheet(view));
}

gi::ValueRange dragged_range(const gi::ValueRange& range, RangeEnd end, double up) {
    const double span = range.high != range.low ? range.high - range.low : 1;
    const double left = std::max(1 + (end == RangeEnd::high ? up : -up), 0.01) * span;
    if (!std::isfinite(left)) return range;
    return end == RangeEnd::high ? gi::ValueRange{range.low, range.low + left}
                                 : gi::ValueRange{range.high - left, range.high};
}

std::vector<Mark> overlay(const gi::Look& look, const gi::ShownValues& values, const OverlayView& view) {
    Sheet sheet(view);
    if (look.legend) draw_legend(sheet, look, values);
    if (look.axes) draw_axes(sheet, view.camera);
    if (look.scale_bar) draw_scale(sheet, view);
    return std::move(sheet.marks);
}

}  // namespace lucarne::viewer
