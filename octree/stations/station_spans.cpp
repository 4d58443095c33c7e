// The most probable station of each run, from all runs together: a hidden Markov model whose states are the
// stations and "none of them" (Viterbi 1967).
#include "octree/stations/station_spans.h"

#include <algorithm>
#include <bitset>
#include <cmath>

#include <glm/geometric.hpp>

#include "octree/stations/find_stations.h"
#include "octree/stations/scan_lines.h"

namespace lucarne::octree {
namespace {

/// Costs of a line that misses the state's station, and of one that has none. A tenth of a station's lines
/// miss it, because their points are on something small; three in ten would mean another station.
constexpr float kMissed = 1, kNoStation = .3f;
/// Cost of a change of the station. A scanner that looks past another station's place sends some profiles
/// through both, which must not look like a change.
constexpr float kChange = 8;
constexpr size_t kLeastSpanLines = 16, kSpanDirections = 18, kLeastSpanDirections = 3;
constexpr double kNearlyAll = .9;  ///< of a scan's points
static_assert(kMostFoundStations <= 64);

/// Returns the stations through which a line passes, as bits.
uint64_t stations_on(const ScanLine& line, const std::vector<glm::dvec2>& places) {
    uint64_t on = 0;
    for (size_t i = 0; i < places.size(); ++i)
        if (passes(line, places[i])) on |= uint64_t{1} << i;
    return on;
}

/// Returns the most probable state of each line: a station, or `stations` for none.
std::vector<uint8_t> likely_states(const std::vector<uint64_t>& on, size_t stations) {
    const size_t states = stations + 1;
    std::vector<float> cost(states, 0);
    std::vector<uint8_t> before(on.size() * states);  // the state of the previous line
    for (size_t line = 0; line < on.size(); ++line) {
        const auto cheapest = static_cast<size_t>(std::ranges::min_element(cost) - cost.begin());
        const float changed = cost[cheapest] + kChange;
        for (size_t state = 0; state < states; ++state) {
            const bool change = changed < cost[state];
            before[line * states + state] = static_cast<uint8_t>(change ? cheapest : state);
            if (change) cost[state] = changed;
            if (state == stations)
                cost[state] += kNoStation;
            else if (!(on[line] >> state & 1))
                cost[state] += kMissed;
        }
    }
    std::vector<uint8_t> states_of(on.size());
    auto state = static_cast<size_t>(std::ranges::min_element(cost) - cost.begin());
    for (size_t line = on.size(); line-- > 0;) {
        states_of[line] = static_cast<uint8_t>(state);
        state = before[line * states + state];
    }
    return states_of;
}

/// Whether lines [first, end) are enough to show that a station saw them: lines from one direction meet in
/// many places.
bool enough(const std::vector<ScanLine>& lines, const std::vector<uint64_t>& on, size_t station, size_t first,
            size_t end) {
    size_t count = 0;
    std::bitset<kSpanDirections> seen;
    for (size_t line = first; line < end; ++line)
        if (on[line] >> station & 1) {
            ++count;
            seen.set(direction_of(lines[line], kSpanDirections));
        }
    return count >= kLeastSpanLines && seen.count() >= kLeastSpanDirections;
}

}  // namespace

std::vector<StationSpan> station_spans(const ScanRuns& runs, const std::vector<glm::dvec3>& stations,
                                       double metres_per_unit) {
    std::vector<StationSpan> spans;
    if (stations.empty()) return spans;
    const auto lines = scan_lines(runs, metres_per_unit);
    std::vector<glm::dvec2> places;
    for (const glm::dvec3& station : stations)
        places.emplace_back(metres_per_unit * (station - runs.origin()));
    std::vector<uint64_t> on;
    for (const ScanLine& line : lines) on.push_back(stations_on(line, places));
    const auto states = likely_states(on, stations.size());
    for (size_t first = 0, last; first < lines.size(); first = last) {
        const size_t station = states[first];
        for (last = first; last < lines.size() && states[last] == station;) ++last;
        if (station == stations.size()) continue;
        // Where one station follows another, lines through both tell nothing.
        const uint64_t own = uint64_t{1} << station;
        const auto other = [&](size_t line) {
            return line < lines.size() && states[line] < stations.size() ? uint64_t{1} << states[line] : 0;
        };
        const uint64_t previous = first > 0 ? other(first - 1) : 0, next = other(last);
        size_t begin = first, end = last;
        while (begin < end && (on[begin] & (own | previous)) != own) ++begin;
        while (begin < end && (on[end - 1] & (own | next)) != own) --end;
        if (!enough(lines, on, station, begin, end)) continue;
        spans.push_back({.station = static_cast<uint32_t>(station),
                         .first = runs.first_point(lines[begin].run),
                         .end = runs.first_point(lines[end - 1].run) + ScanRuns::kRunPoints});
        if (spans.size() == kMostStationSpans) break;
    }
    return spans;
}

bool saw_all(const ScanRuns& runs, const std::vector<StationSpan>& spans) {
    uint64_t seen = 0;
    for (const StationSpan& span : spans) seen += span.end - span.first;
    return static_cast<double>(seen) > kNearlyAll * static_cast<double>(runs.points());
}

}  // namespace lucarne::octree
