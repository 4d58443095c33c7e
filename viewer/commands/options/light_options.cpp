#include "viewer/commands/options/light_options.h"

#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gi/registry.h"
#include "viewer/commands/find_name.h"

namespace lucarne::viewer {
namespace {

Result<gi::ValueRange> parse_luminance(const std::string& text) {
    gi::ValueRange range;
    const char* const end = text.data() + text.size();
    const auto [colon, low] = std::from_chars(text.data(), end, range.low);
    if (low == std::errc() && colon != end && *colon == ':') {
        const auto [last, high] = std::from_chars(colon + 1, end, range.high);
        if (high == std::errc() && last == end && range.low >= 1e-9 && range.high > range.low &&
            range.high <= 1e15)
            return range;
    }
    return bad_arguments("--luminance", fmt::format("'{}' is not a range of luminances", text),
                         "give two positive numbers, the lower one first: 0.1:1000");
}

}  // namespace

void add_light_options(Arguments& command, LightOptions& options) {
    command
        .add("--tone-map", options.tone_map,
             fmt::format("How radiance is shown: {}", fmt::join(gi::tone_map_names(), ", ")))
        .type_name("NAME");
    command
        .add("--luminance", options.luminance,
             "Range of false colours, cd/m2 or with illuminance lx; by default around the exposure")
        .type_name("LOW:HIGH");
    command.add("--albedo", options.albedo, "Scale of the points' albedo").range(0.0, 10.0).type_name("X");
    command.add("--flatten", options.flatten, "Share of the light in the points' colours to divide out")
        .range(0.0, 1.0)
        .type_name("X");
    command.flag("--unbalanced", options.unbalanced,
                 "Keep colours as they were recorded: stations' different exposures, random differences of "
                 "neighbouring points, and points that were never photographed black");
    command.add("--beside", options.compare, "Show this engine beside the picture's own (.png)")
        .type_name("ENGINE");
    command
        .add("--beside-show", options.compare_show,
             fmt::format("How the two engines are compared: {}", fmt::join(gi::comparison_names(), ", ")))
        .type_name("HOW");
    command
        .add("--border", options.border,
             "Where a split comparison's border is, as a share of the width from the left")
        .range(0.0, 1.0)
        .type_name("X");
    command
        .add("--difference-range", options.difference_range,
             "Difference of exposed luminance at the end of the colour map")
        .range(1e-6, 1e6)
        .type_name("X");
}

Result<void> apply(const LightOptions& options, gi::Scene& scene) {
    if (!options.tone_map.empty()) {
        LUCARNE_ASSIGN(const size_t curve, find_name("--tone-map", options.tone_map, gi::tone_map_names()));
        scene.tone_map = static_cast<gi::ToneMap>(curve);
    }
    if (!options.luminance.empty()) {
        LUCARNE_ASSIGN(scene.luminance, parse_luminance(options.luminance));
    }
    scene.albedo.scale = options.albedo.value_or(scene.albedo.scale);
    scene.albedo.flatten = options.flatten.value_or(scene.albedo.flatten);
    if (options.unbalanced) scene.albedo.balance = false;
    if (!options.compare.empty()) {
        LUCARNE_TRY(gi::find_engine(options.compare));
        if (!scene.comparison) scene.comparison.emplace();
        scene.comparison->engine = options.compare;
    }
    const bool shown = !options.compare_show.empty() || options.border || options.difference_range;
    if (!scene.comparison)
        return shown ? bad_arguments("--beside", "nothing is compared", "name an engine") : Result<void>();
    if (!options.compare_show.empty()) {
        LUCARNE_ASSIGN(const size_t show,
                       find_name("--beside-show", options.compare_show, gi::comparison_names()));
        scene.comparison->show = static_cast<gi::Comparison::Show>(show);
    }
    scene.comparison->border = options.border.value_or(scene.comparison->border);
    scene.comparison->range = options.difference_range.value_or(scene.comparison->range);
    return {};
}

}  // namespace lucarne::viewer
