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

/// A vertical slice through a cloud: what stands over or under the line between two points and no further
/// than half the thickness beside it. World units.
struct Slice {
    glm::dvec3 from{0.0}, to{0.0};
    double thickness = 0;

    static Slice of(const Measurement& section) {
        return {section.points.front().position, section.points.back().position, section.thickness};
    }
    bool operator==(const Slice&) const = default;
};

struct SectionPoint {
    double along = 0, across = 0;  ///< from `from` on the map; across: to the left
    double height = 0;             ///< z
    std::array<uint8_t, 3> color{};
    gi::PointPlace place;
};

struct Section {
    Slice slice;
    /// An even sample where `complete` is false: whole levels of the octree.
    std::vector<SectionPoint> points;
    bool complete = false;
    uint64_t nodes_read = 0, nodes = 0;
    double lowest = 0, highest = 0;  ///< of the points; both 0 without any
};

inline constexpr size_t kMostSectionPoints = 2'000'000;  ///< 96 MB

/// Reads the slice out of core, from the coarse levels to the fine ones, until the next would give more than
/// `most` points. `progress` is told what is there after each level, and after so many nodes; false ends it.
/// The same points in the same order on every run. Errors: a node that cannot be read; a line of no length
/// (arguments).
Result<Section> read_section(const octree::NodeSource& source, const Slice& slice, size_t most,
                             const std::function<bool(const Section&, bool level_done)>& progress);

/// Writes `base`.csv (RFC 4180: along, across, height, x, y, z and every attribute; coordinates as their file
/// has them) and `base`.svg, a drawing with axes in the chosen unit. `cache` is of the section's source.
/// Errors: files that are there, unless `overwrite`, or cannot be written; a node that cannot be read.
Result<void> write_section(const std::filesystem::path& base, const Section& section,
                           const std::string& title, const UnitChoice& units, NodeCache& cache,
                           bool overwrite);

}  // namespace lucarne::viewer
