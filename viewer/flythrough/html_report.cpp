#include "viewer/flythrough/html_report.h"

#include <fmt/format.h>

#include "io/core/options.h"
#include "viewer/flythrough/svg_plot.h"

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;
using Flights = std::vector<Json>;

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --line: #8884; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; margin: .5rem 0; }
td, th { padding: .2rem .9rem .2rem 0; text-align: left; border-bottom: 1px solid var(--line); font-weight: normal;
         vertical-align: top; }
thead th { font-weight: 600; } td.n { text-align: right; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
svg { width: 100%; height: auto; margin: .6rem 0; } svg text { font-size: 12px; fill: currentColor; }
svg .title { font-size: 13px; font-weight: 600; } svg .grid { stroke: currentColor; stroke-opacity: .18; }
)";

std::string text_of(const Json& value) {
    if (value.is_string()) return escaped(value.get<std::string>());
    if (value.is_null()) return "&ndash;";
    if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
    return escaped(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string number(double value, const char* unit = "") {
    return fmt::format(R"(<td class="n">{:.4g}{}</td>)", value, unit);
}
std::string bytes_cell(const Json& value) {
    return fmt::format(R"(<td class="n">{}</td>)", bytes_text(value.get<uint64_t>()));
}
std::string seconds_cell(const Json& value) {
    return value.is_null() ? R"(<td class="n">&ndash;</td>)" : number(value.get<double>(), " s");
}

/// Returns a table with one row for each figure and one column for each flight.
std::string figures(const Flights& flights) {
    std::string html = "<div class=wide><table><thead><tr><th></th>";
    for (const Json& flight : flights) html += fmt::format("<th>{}</th>", escaped(flight_name(flight)));
    html += "</tr></thead>";
    const auto row = [&](const char* name, const auto& cell) {
        html += fmt::format("<tr><th>{}</th>", name);
        for (const Json& flight : flights) html += cell(flight);
        html += "</tr>";
    };
    row("frames", [](const Json& f) { return number(f["frames"].get<double>()); });
    for (const char* key : {"p50", "p95", "p99", "max"})
        row(fmt::format("frame, {}", key).c_str(),
            [&](const Json& f) { return number(f["frame_ms"][key].get<double>(), " ms"); });
    row("loading in the frame, p99",
        [](const Json& f) { return number(f["loading_ms"]["p99"].get<double>(), " ms"); });
    row("points a frame, view cut",
        [](const Json& f) { return number(f["points_per_frame"]["view"]["mean"].get<double>()); });
    row("cuts complete, mean",
        [](const Json& f) { return number(100 * f["complete"]["mean"].get<double>(), " %"); });
    row("loaded", [](const Json& f) { return bytes_cell(f["bytes_loaded"]); });
    row("memory used", [](const Json& f) { return bytes_cell(f["memory"]["used"]); });
    row("of the cap", [](const Json& f) { return bytes_cell(f["memory"]["cap"]); });
    row("device memory used", [](const Json& f) { return bytes_cell(f["device_memory"]["used"]); });
    row("of the cap", [](const Json& f) { return bytes_cell(f["device_memory"]["cap"]); });
    row("first picture after",
        [](const Json& f) { return seconds_cell(f["start"]["first_picture_seconds"]); });
    row("first complete cut after",
        [](const Json& f) { return seconds_cell(f["start"]["complete_cut_seconds"]); });
    return html + "</table></div>";
}

std::vector<double> column(const Json& flight, const char* key, double scale = 1) {
    std::vector<double> values;
    for (const Json& frame : flight["each_frame"]) values.push_back(frame[key].get<double>() * scale);
    return values;
}

/// Returns the frames' times on the path. For a soak, which repeats the path, returns wall-clock times.
std::vector<double> times(const Json& flight) {
    return column(flight, flight.contains("soak") ? "wall" : "time");
}

std::string plot_of(const Flights& flights, const char* title, const char* unit, const char* key,
                    double scale) {
    Plot plot{title, "s along the flight", unit, {}};
    for (const Json& flight : flights)
        plot.curves.push_back({flight_name(flight), times(flight), column(flight, key, scale)});
    return svg_of(plot);
}

/// Returns a stacked plot of one flight's passes. Passes that are always negligible are combined.
std::string passes_plot(const Json& flight) {
    Plot plot{"passes, " + flight_name(flight), "s along the flight", "ms", {}, true};
    const std::vector<double> x = times(flight);
    double most = 0;
    for (const auto& [name, of_pass] : flight["passes_ms"].items())
        most = std::max(most, of_pass["mean"].get<double>());
    Curve rest{"rest", x, std::vector<double>(x.size(), 0.0)};
    size_t index = 0;
    for (const auto& [name, of_pass] : flight["passes_ms"].items()) {
        std::vector<double> y;
        for (const Json& frame : flight["each_frame"]) y.push_back(frame["passes_ms"][index].get<double>());
        ++index;
        if (of_pass["mean"].get<double>() >= 0.05 * most) {
            plot.curves.push_back({name, x, std::move(y)});
        } else {
            for (size_t i = 0; i < y.size(); ++i) rest.y[i] += y[i];
        }
    }
    plot.curves.push_back(std::move(rest));
    return svg_of(plot);
}

std::string facts(const Json& object) {
    std::string html = "<table>";
    for (const auto& [name, value] : object.items())
        html += fmt::format("<tr><th>{}</th><td>{}</td></tr>", escaped(name), text_of(value));
    return html + "</table>";
}

}  // namespace

std::string flight_name(const Json& flight) {
    return flight["engine"].get<std::string>() + (flight["start"]["cold"].get<bool>() ? ", cold" : "");
}

std::string html_report(const Flights& flights) {
    std::string html = fmt::format(
        "<!doctype html>\n<html lang=en><meta charset=utf-8><meta name=viewport "
        "content=\"width=device-width\"><title>Lucarne: flythrough</title><style>{}</style>\n"
        "<h1>Lucarne: flythrough</h1>\n",
        kStyle);
    if (flights.empty()) return html + "<p>No flight.</p></html>\n";
    const Json& first = flights.front();
    html += fmt::format("<p>{} along {}, {} x {}, preset {}, {}.</p>\n", text_of(first["input"]),
                        text_of(first["path"]), text_of(first["size"][0]), text_of(first["size"][1]),
                        text_of(first["preset"]),
                        first["mode"] == "wait" ? "with complete cuts" : "in real time");
    html += figures(flights) + "<h2>Along the flight</h2>\n";
    html += plot_of(flights, "frame", "ms", "ms", 1);
    html += plot_of(flights, "points drawn", "of all cuts", "points", 1);
    html += plot_of(flights, "cuts complete", "%", "complete", 100);
    html += plot_of(flights, "loaded", "MiB", "bytes_loaded", 0x1p-20);
    html += plot_of(flights, "resident memory", "MiB", "resident_memory", 0x1p-20);
    html += "<h2>Passes</h2>\n";
    for (const Json& flight : flights) html += passes_plot(flight);
    html += "<h2>Machine</h2>\n" + facts(first["machine"]) + facts(first["device"]);
    html += "<h2>Build</h2>\n" + facts(first["build"]);
    html += "<h2>Settings</h2>\n" + facts(first["settings"]);
    return html + "</html>\n";
}

}  // namespace lucarne::viewer
