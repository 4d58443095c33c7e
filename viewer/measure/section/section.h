#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gi/surfels/surfel_pool.h"
#include "viewer/measure/measurement.h"
#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

/// A vertical slice through a cloud: the points above or below the line between two points, at most half the
/// thickness beside it. World units.
struct Slice {
    glm::dvec3 from{0.0}, to{0.0};
    double thickness = 0;

    static Slice of(const Measurement& section) {
        return {section.points.front().position, section.points.back().position, section.thickness};
    }
    bool operator==(const Slice&) const = default;
};

struct SectionPoint {
    double along = 0, across = 0;  ///< horizontal distance from `from`; `across` is positive to the left
    double height = 0;             ///< z
    std::array<uint8_t, 3> color{};
    gi::PointPlace place;
};

struct Section {
    Slice slice;
    /// If `complete` is false, an even sample: complete levels of the octree.
    std::vector<SectionPoint> points;
    bool complete = false;
    uint64_t nodes_read = 0, nodes = 0;
    double lowest = 0, highest = 0;  ///< heights of the points; both 0 if there are none
};

inline constexpr size_t kMostSectionPoints = 2'000'000;  ///< 96 MB

/// Reads the slice out of core, from coarse levels to fine ones, until the next level would exceed `most`
/// points. Calls `progress` with the section so far after each level and after every few nodes; reading ends
/// when it returns false. The points and their order are the same on every run. Errors: a node cannot be
/// read; the line has no length (arguments).
Result<Section> read_section(const octree::NodeSource& source, const Slice& slice, size_t most,
                             const std::function<bool(const Section&, bool level_done)>& progress);

/// Writes `base`.csv (RFC 4180: along, across, height, x, y, z and every attribute; coordinates as in their
/// file) and `base`.svg, a drawing with axes in the chosen unit. `cache` must belong to the section's source.
/// Errors: a file exists and `overwrite` is false; a file cannot be written; a node cannot be read.
Result<void> write_section(const std::filesystem::path& base, const Section& section,
                           const std::string& title, const UnitChoice& units, NodeCache& cache,
                           bool overwrite);

}  // namespace lucarne::viewer
