#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/stations/scan_runs.h"

namespace lucarne::octree {

/// A part of a scan that one station saw: its points [first, end), counted in the order of the scan.
struct StationSpan {
    uint32_t scan = 0;     ///< index of the scan
    uint32_t station = 0;  ///< index of the station
    uint64_t first = 0, end = 0;
    bool operator==(const StationSpan&) const = default;
};

/// The most spans of a scan.
inline constexpr size_t kMostStationSpans = 256;

/// Finds which parts of a scan each of its stations saw (the result of find_stations): where the profiles of
/// consecutive runs meet in it. Stations are counted as in `stations`. Returns disjoint spans in the order of
/// the scan. Points in no span may have been seen from anywhere, and so has every point where the stations'
/// points are mixed in the file.
std::vector<StationSpan> station_spans(const ScanRuns& runs, const std::vector<glm::dvec3>& stations,
                                       double metres_per_unit);

/// Whether the only station of a scan saw all of it: its spans have nearly all points.
bool saw_all(const ScanRuns& runs, const std::vector<StationSpan>& spans);

}  // namespace lucarne::octree
