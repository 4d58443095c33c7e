#include "viewer/flythrough/report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;

double mean(const std::vector<double>& values) {
    return values.empty()
               ? 0
               : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Mean and quantiles of times, in milliseconds.
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

/// The passes in the order in which they first appear; a frame without one took no time for it.
Json passes(std::span<const FlownFrame> frames) {
    std::vector<std::string> names;
    for (const FlownFrame& frame : frames)
        for (const auto& pass : frame.stats.passes)
            if (std::ranges::find(names, pass.name) == names.end()) names.push_back(pass.name);
    Json result = Json::object();
    for (const std::string& name : names)
        result[name] = times(of_all(frames, [&](const FrameStats& stats) {
            double seconds = 0;
            for (const auto& pass : stats.passes) seconds += pass.name == name ? pass.seconds : 0;
            return seconds;
        }));
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

/// Bytes: the caps, and the most that was used of them; what the process held resident.
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

/// Mean luminance along the flight, and how it flickers; nothing where neither was measured.
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

Json each_frame(std::span<const FlownFrame> frames) {
    Json list = Json::array();
    for (const FlownFrame& frame : frames) {
        list.push_back({{"time", frame.time},
                        {"ms", frame.stats.seconds * 1e3},
                        {"points", frame.stats.ready_points},
                        {"complete", frame.stats.complete()},
                        {"cut_share", frame.stats.cut_share},
                        {"resident_memory", frame.stats.memory.resident}});
        if (frame.luminance) list.back()["luminance"] = *frame.luminance;
        if (frame.flicker) list.back()["flicker"] = frame.flicker->change;
    }
    return list;
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
    report["input"] = conditions.input;
    report["path"] = conditions.path;
    report["mode"] = conditions.mode;
    report["engine"] = conditions.engine;
    report["preset"] = conditions.preset;
    report["settings"] = {{"bounces", conditions.settings.bounces},
                          {"vpls", conditions.settings.vpls},
                          {"interleave", conditions.settings.interleave},
                          {"atlas", conditions.settings.atlas},
                          {"seed", conditions.settings.seed},
                          {"view_budget", conditions.budgets.view},
                          {"light_view_budget", conditions.budgets.light_view},
                          {"light_budget", conditions.budgets.light}};
    report["size"] = {conditions.size.width, conditions.size.height};
    report["device"] = {{"vendor", conditions.device.vendor},
                        {"renderer", conditions.device.renderer},
                        {"version", conditions.device.version},
                        {"software", conditions.device.software}};
    report["frames"] = frames.size();
    report["seconds"] = conditions.wall_seconds;
    report["frame_ms"] = times(of_all(frames, [](const FrameStats& stats) { return stats.seconds; }));
    report["passes_ms"] = passes(frames);
    report["points_per_frame"] = points(frames);
    report["bytes_loaded"] = frames.empty() ? 0 : frames.back().stats.bytes_loaded;
    memory(conditions, frames, report);
    light(frames, report);
    report["complete"] = {{"mean", mean(complete)},
                          {"least", complete.empty() ? 0 : *std::ranges::min_element(complete)},
                          {"last", complete.empty() ? 0 : complete.back()}};
    report["each_frame"] = each_frame(frames);
    return report;
}

}  // namespace lucarne::viewer
