#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/stations/scan_runs.h"

namespace lucarne::octree {

/// The most stations that are looked for in one scan.
inline constexpr size_t kMostFoundStations = 64;

/// Where a scanner stood, as a scan's points show.
struct FoundStations {
    std::vector<glm::dvec3> positions;    ///< in the scan's coordinates
    std::vector<int32_t> station_of_run;  ///< index into `positions` for each run; -1: not known
};

/// Finds the stations of a terrestrial scan from the order of its points (octree/stations/README.md). Returns
/// none where the points do not show any: other kinds of scans, points that were sorted or thinned evenly.
/// `metres_per_unit`: of the scan's coordinates.
FoundStations find_stations(const ScanRuns& runs, double metres_per_unit);

}  // namespace lucarne::octree
