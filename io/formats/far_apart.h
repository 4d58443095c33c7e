#pragma once

#include <array>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::io {

/// Where a scan lies.
struct PlacedScan {
    std::string name;
    std::array<glm::dvec3, 2> box;  ///< lowest and highest corner; that of a damaged file may be anything
};

/// Returns a warning if scans lie in two groups with more than a hundred times the larger group's diagonal
/// between them, as scans in projected and in local coordinates do; empty otherwise. Names one of each group.
/// Boxes that are not finite do not count.
std::string far_apart(std::span<const PlacedScan> scans);
/// The same for the boxes that the scans' headers state.
std::string far_apart(std::span<const ScanInfo> scans);

}  // namespace lucarne::io
