#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Neighbour {
    double distance2 = 0;  ///< squared distance to the query
    uint32_t index = 0;
};

/// Finds nearest neighbours among points in double precision. Searching is thread-safe.
class PointIndex {
 public:
    virtual ~PointIndex() = default;

    /// Merges this index's points into `nearest`, whose first `found` entries are already sorted by distance.
    /// `offset` is added to the points' indices. Returns the new number of entries.
    virtual size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                                 uint32_t offset) const = 0;
    /// Appends the points within `radius` of a box to `tile`, numbered from `offset`; may append some that
    /// are farther. Returns false as soon as the tile has more than `most` points: then some are missing.
    virtual bool gather(const Box& box, double radius, uint32_t offset, size_t most, Tile& tile) const = 0;
};

/// Makes an index of the given kind; returns null if there are no points. `points` must be scaled as
/// ChunkCache does, outlive the index, and be in the order of morton_order().
std::unique_ptr<PointIndex> make_index(NeighbourSearch search, const PointArrays& points);
/// Makes PCL's default index: FLANN's single kd-tree. The points may be in any order.
std::unique_ptr<PointIndex> make_flann_index(const PointArrays& points);

/// Returns the order of points along a Morton curve of 21 bits an axis through their bounds. Points at the
/// same position stay together, in their old order.
std::vector<uint32_t> morton_order(std::span<const glm::dvec3> points);

}  // namespace lucarne::octree
