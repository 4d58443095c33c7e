#include "viewer/flythrough/report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gi/registry.h"
#include "gi/scene/render_settings_file.h"

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kLoadPass = "load";  // the pipeline's name for the pass

double mean(const std::vector<double>& values) {
    return values.empty()
               ? 0
               : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Returns mean and quantiles of times, in milliseconds.
Json times(const std::vector<double>& seconds) {
    std::vector<double> ms;
    for (const double value : seconds) ms.push_back(value * 1e3);
    return {{"mean", mean(ms)},
            {"p50", quantile(ms, 0.5)},
            {"p95", quantile(ms, 0.95)},
            {"p99", quantile(ms, 0.99)},
            {"max", ms.empty() ? 0 : *std::ranges::max_element(ms)}};
}

template <class Get>
std::vector<double> of_all(std::span<const FlownFrame> frames, const Get& get) {
    std::vector<double> values;
    for (const FlownFrame& frame : frames) values.push_back(static_cast<double>(get(frame.stats)));
    return values;
}

double seconds_of(const FrameStats& stats, std::string_view pass_name) {
    double seconds = 0;
    for (const auto& pass : stats.passes) seconds += pass.name == pass_name ? pass.seconds : 0;
    return seconds;
}

/// Reports the passes in the order of their first appearance. A frame without a pass counts as zero time for
/// it.
Json passes(std::span<const FlownFrame> frames) {
    std::vector<std::string> names;
    for (const FlownFrame& frame : frames)
        for (const auto& pass : frame.stats.passes)
            if (std::ranges::find(names, pass.name) == names.end()) names.push_back(pass.name);
    Json result = Json::object();
    for (const std::string& name : names)
        result[name] =
            times(of_all(frames, [&](const FrameStats& stats) { return seconds_of(stats, name); }));
    return result;
}

Json points(std::span<const FlownFrame> frames) {
    const auto of = [&](uint64_t FrameStats::*member) {
        const auto values = of_all(frames, [&](const FrameStats& stats) { return stats.*member; });
        return Json{{"mean", std::round(mean(values))},
                    {"max", values.empty() ? 0 : *std::ranges::max_element(values)}};
    };
    return {{"view", of(&FrameStats::view_points)},
            {"light_views", of(&FrameStats::light_view_points)},
            {"light", of(&FrameStats::light_points)}};
}

double largest(const std::vector<double>& values) {
    return values.empty() ? 0 : *std::ranges::max_element(values);
}

/// Reports the memory caps, the largest use of each, and the process's resident memory, bytes.
void memory(const FlightConditions& conditions, std::span<const FlownFrame> frames, Json& report) {
    const auto of = [&](uint64_t MemoryUse::*member) {
        return of_all(frames, [&](const FrameStats& stats) { return stats.memory.*member; });
    };
    const auto resident = of(&MemoryUse::resident);
    report["memory"] = {{"cap", conditions.caps.memory}, {"used", largest(of(&MemoryUse::host))}};
    report["device_memory"] = {{"cap", conditions.caps.device_memory},
                               {"used", largest(of(&MemoryUse::device))}};
    report["resident_memory"] = {{"mean", std::round(mean(resident))},
                                 {"max", largest(resident)},
                                 {"last", resident.empty() ? 0 : resident.back()}};
}

/// Reports the mean luminance and the flicker along the flight, if they were measured.
void light(std::span<const FlownFrame> frames, Json& report) {
    std::vector<double> luminance, change, matched;
    for (const FlownFrame& frame : frames) {
        if (frame.luminance) luminance.push_back(*frame.luminance);
        if (!frame.flicker) continue;
        change.push_back(frame.flicker->change);
        matched.push_back(frame.flicker->matched);
    }
    if (luminance.empty()) return;
    report["luminance"] = {{"mean", mean(luminance)}};
    report["flicker"] = {{"mean", mean(change)},
                         {"p95", quantile(change, 0.95)},
                         {"max", largest(change)},
                         {"matched", mean(matched)}};
}

Json each_frame(std::span<const FlownFrame> frames, const Json& pass_names) {
    Json list = Json::array();
    for (const FlownFrame& frame : frames) {
        Json passes = Json::array();
        for (const auto& [name, times_of_it] : pass_names.items())
            passes.push_back(1e3 * seconds_of(frame.stats, name));
        list.push_back({{"time", frame.time},
                        {"wall", frame.wall},
                        {"ms", frame.stats.seconds * 1e3},
                        {"passes_ms", std::move(passes)},
                        {"points", frame.stats.ready_points},
                        {"complete", frame.stats.complete()},
                        {"cut_share", frame.stats.cut_share},
                        {"bytes_loaded", frame.stats.bytes_loaded},
                        {"resident_memory", frame.stats.memory.resident}});
        if (frame.luminance) list.back()["luminance"] = *frame.luminance;
        if (frame.flicker) list.back()["flicker"] = frame.flicker->change;
        if (frame.change) list.back()["change"] = frame.change->whole;
    }
    return list;
}

/// Reports times since the opening of the files.
Json start(const FlightConditions& conditions, std::span<const FlownFrame> frames) {
    Json result = {{"cold", conditions.start.cold},
                   {"still_cached", conditions.start.still_cached},
                   {"open_seconds", conditions.start.open_seconds},
                   {"first_picture_seconds", nullptr},
                   {"complete_cut_seconds", nullptr}};
    if (!frames.empty())
        result["first_picture_seconds"] = conditions.start.open_seconds + frames.front().wall;
    const auto whole = std::ranges::find_if(frames, [](const FlownFrame& frame) {
        return frame.stats.nodes_pending == 0 && frame.stats.complete() >= 1;
    });
    if (whole != frames.end()) result["complete_cut_seconds"] = conditions.start.open_seconds + whole->wall;
    return result;
}

struct Changes {
    std::vector<double> whole, tile;
};
Changes changes_of(std::span<const FlownFrame> frames) {
    Changes changes;
    for (const FlownFrame& frame : frames) {
        if (!frame.change) continue;
        changes.whole.push_back(frame.change->whole);
        changes.tile.push_back(frame.change->tile);
    }
    return changes;
}

/// Reports changes from picture to picture, and their ratio to those at full resolution.
void picture_change(const FlightConditions& conditions, std::span<const FlownFrame> frames, Json& report) {
    const Changes own = changes_of(frames);
    if (own.whole.empty()) return;
    report["picture_change"] = {
        {"mean", mean(own.whole)}, {"max", largest(own.whole)}, {"tile_max", largest(own.tile)}};
    if (!conditions.full) return;
    const Changes full = changes_of(conditions.full->frames);
    const auto ratio = [](double a, double b) { return b > 0 ? a / b : 0; };
    report["popping"] = {{"full_mean", mean(full.whole)},
                         {"full_max", largest(full.whole)},
                         {"full_tile_max", largest(full.tile)},
                         {"full_cut_share", conditions.full->cut_share},
                         {"ratio", ratio(largest(own.whole), largest(full.whole))},
                         {"tile_ratio", ratio(largest(own.tile), largest(full.tile))}};
}

void soak(const FlightConditions& conditions, Json& report) {
    if (!conditions.soak) return;
    const Soak& flown = *conditions.soak;
    const auto of = [&](uint64_t MemoryUse::*member) {
        return Json{
            {"first_lap", flown.first.*member},
            {"last_lap", flown.last.*member},
            {"growth", static_cast<int64_t>(flown.last.*member) - static_cast<int64_t>(flown.first.*member)}};
    };
    report["soak"] = {{"laps", flown.laps},
                      {"frames", flown.frames},
                      {"resident_memory", of(&MemoryUse::resident)},
                      {"memory", of(&MemoryUse::host)},
                      {"device_memory", of(&MemoryUse::device)}};
}

Json prefetch(std::span<const FlownFrame> frames) {
    if (frames.empty()) return {};
    const FrameStats& last = frames.back().stats;
    return {{"nodes_loaded_ahead", last.ahead_loads}, {"seen_later", last.ahead_hits}};
}

void surroundings(const FlightConditions& conditions, Json& report) {
    report["device"] = {{"vendor", conditions.device.vendor},
                        {"renderer", conditions.device.renderer},
                        {"version", conditions.device.version},
                        {"software", conditions.device.software}};
    report["machine"] = {{"processor", conditions.machine.processor},
                         {"cores", conditions.machine.cores},
                         {"memory", conditions.machine.memory},
                         {"system", conditions.machine.system}};
    report["build"] = {{"version", conditions.build.version},
                       {"revision", conditions.build.revision},
                       {"compiler", conditions.build.compiler},
                       {"type", conditions.build.type},
                       {"flags", conditions.build.flags}};
}

/// Returns the engine's options and the budgets.
Json settings(const FlightConditions& conditions) {
    Json result = Json::object();
    if (const auto engine = gi::find_engine(conditions.engine))
        for (const gi::OptionInfo* option : (*engine)->info.options)
            result[std::string(option->key)] = gi::option_json(*option, conditions.settings.get(*option));
    result["view_budget"] = conditions.budgets.view;
    result["light_view_budget"] = conditions.budgets.light_view;
    result["light_budget"] = conditions.budgets.light;
    return result;
}

}  // namespace

double quantile(std::vector<double> values, double q) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const double rank = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const size_t below = static_cast<size_t>(rank), above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (rank - static_cast<double>(below));
}

Json flight_report(const FlightConditions& conditions, std::span<const FlownFrame> frames) {
    const auto complete = of_all(frames, [](const FrameStats& stats) { return stats.complete(); });
    Json report;
    report["input"] = conditions.inputs.size() == 1 ? Json(conditions.inputs[0]) : Json(conditions.inputs);
    report["path"] = conditions.path;
    report["mode"] = conditions.mode;
    report["engine"] = conditions.engine;
    report["preset"] = conditions.preset;
    report["settings"] = settings(conditions);
    report["size"] = {conditions.size.width, conditions.size.height};
    if (conditions.frame_time > 0) report["frame_time_ms"] = conditions.frame_time * 1e3;
    if (conditions.light_seconds) report["light_time_ms"] = *conditions.light_seconds * 1e3;
    surroundings(conditions, report);
    report["start"] = start(conditions, frames);
    report["frames"] = frames.size();
    report["seconds"] = conditions.wall_seconds;
    report["frame_ms"] = times(of_all(frames, [](const FrameStats& stats) { return stats.seconds; }));
    report["passes_ms"] = passes(frames);
    // The time that the frame's thread spends on the stream: requests, arrivals and their upload.
    report["loading_ms"] =
        times(of_all(frames, [](const FrameStats& stats) { return seconds_of(stats, kLoadPass); }));
    report["points_per_frame"] = points(frames);
    report["bytes_loaded"] = frames.empty() ? 0 : frames.back().stats.bytes_loaded;
    report["prefetch"] = prefetch(frames);
    memory(conditions, frames, report);
    soak(conditions, report);
    light(frames, report);
    picture_change(conditions, frames, report);
    report["complete"] = {{"mean", mean(complete)},
                          {"least", complete.empty() ? 0 : *std::ranges::min_element(complete)},
                          {"last", complete.empty() ? 0 : complete.back()}};
    report["each_frame"] = each_frame(frames, report["passes_ms"]);
    return report;
}

}  // namespace lucarne::viewer
