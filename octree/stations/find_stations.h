#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/stations/scan_runs.h"

namespace lucarne::octree {

/// The most stations that are looked for in one scan.
inline constexpr size_t kMostFoundStations = 64;

/// Finds where the scanner of a terrestrial scan stood, in the scan's coordinates, from the order of its
/// points (octree/stations/README.md). Returns none where the points do not show any: other kinds of scans,
/// points that were sorted or thinned evenly. `metres_per_unit`: of the scan's coordinates.
std::vector<glm::dvec3> find_stations(const ScanRuns& runs, double metres_per_unit);

}  // namespace lucarne::octree
