#include "viewer/overlay/figure_scale.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gi/post/false_colour.h"
#include "viewer/overlay/axis_marks.h"

namespace lucarne::viewer {
namespace {

using glm::dvec2;

struct Tick {
    double place;  ///< position along the bar, 0 to 1
    std::string text;
};
struct Scale {
    std::string title;
    gi::ColourMap map;
    std::vector<Tick> ticks;
};

std::vector<Mark> draw(const Scale& scale, const OverlayView& view) {
    constexpr int kBands = 96;
    const double em = view.font, free = view.size.width - view.left - view.right;
    const double length = std::min(26 * em, std::max(free - 4 * em, 8 * em));
    const dvec2 from(view.left + std::max(free - length, 0.0) / 2, view.size.height - view.bottom - 3.2 * em);
    std::vector<Mark> marks;
    marks.push_back({Mark::Kind::area, from - dvec2(1.5 * em, 1.7 * em),
                     from + dvec2(length + 1.5 * em, 2.5 * em), glm::vec3(0.08f), 0.6f});
    const glm::vec3 ink(0.95f);
    const auto text = [&](const dvec2& at, const std::string& words) {
        marks.push_back({Mark::Kind::text, at, at, ink, 1, words});
    };
    text(from - dvec2(0, 1.5 * em), scale.title);
    for (int i = 0; i < kBands; ++i)
        marks.push_back({Mark::Kind::area, from + dvec2(length * i / kBands, 0),
                         from + dvec2(length * (i + 1) / kBands, em),
                         gi::mapped_colour(scale.map, (i + 0.5) / kBands)});
    for (const Tick& tick : scale.ticks) {
        const dvec2 at = from + dvec2(length * tick.place, em);
        marks.push_back({Mark::Kind::line, at, at + dvec2(0, 0.35 * em), ink});
        text(at + dvec2(-0.25 * em * static_cast<double>(tick.text.size()), 0.4 * em), tick.text);
    }
    return marks;
}

/// Returns ticks at powers of ten and, if these are few, also at two and five times them.
std::vector<Tick> logarithmic_ticks(const gi::ValueRange& range) {
    const double low = std::log10(range.low), high = std::log10(range.high);
    const int step = std::max(1, static_cast<int>((high - low) / 7));
    std::vector<Tick> ticks;
    for (int power = static_cast<int>(std::floor(low)); power <= high; power += step)
        for (const double factor : {1.0, 2.0, 5.0}) {
            if (factor > 1 && high - low > 2.5) continue;
            const double value = factor * std::pow(10.0, power),
                         place = (std::log10(value) - low) / (high - low);
            if (place > -1e-9 && place < 1 + 1e-9) ticks.push_back({place, fmt::format("{:g}", value)});
        }
    return ticks;
}

}  // namespace

std::vector<Mark> figure_scale(const gi::Scene& scene, double ev, const OverlayView& view) {
    using Show = gi::Comparison::Show;
    if (scene.comparison && scene.comparison->show != Show::split) {
        const bool absolute = scene.comparison->show == Show::absolute_difference;
        const double low = absolute ? 0 : -scene.comparison->range, high = scene.comparison->range;
        Scale scale{fmt::format("difference from {}, exposed luminance", scene.comparison->engine),
                    absolute ? gi::kDifferenceMap : gi::kSignedMap,
                    {}};
        for (const double tick : nice_marks(low, high, 5))
            scale.ticks.push_back({(tick - low) / (high - low), fmt::format("{:g}", tick)});
        return draw(scale, view);
    }
    if (!gi::shows_figures(scene.tone_map)) return {};
    const bool luminance = scene.tone_map == gi::ToneMap::false_colour;
    const gi::ValueRange range = gi::false_colour_range(scene.tone_map, scene.luminance, ev);
    return draw(
        {luminance ? "luminance, cd/m2" : "illuminance, lx", gi::kLuminanceMap, logarithmic_ticks(range)},
        view);
}

}  // namespace lucarne::viewer
