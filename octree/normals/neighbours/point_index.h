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

/// Nearest neighbours among points held in double precision. Searching is thread-safe.
class PointIndex {
 public:
    virtual ~PointIndex() = default;

    /// Merges this index' points into `nearest`, whose first `found` entries are sorted by distance already;
    /// an index of the result is the point's plus `offset`. Returns how many entries are filled now.
    virtual size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                                 uint32_t offset) const = 0;
    /// Appends the points within `radius` of a box to `tile`, numbered from `offset`, perhaps some that are
    /// farther, too. False as soon as the tile has more than `most` points: then some are missing.
    virtual bool gather(const Box& box, double radius, uint32_t offset, size_t most, Tile& tile) const = 0;
};

/// An index of the kind wanted; none of no points. `points` must be scaled as ChunkCache does it, outlive the
/// index, and stand in the order of morton_order().
std::unique_ptr<PointIndex> make_index(NeighbourSearch search, const PointArrays& points);
/// PCL's usual: FLANN's single kd-tree. In whatever order the points are.
std::unique_ptr<PointIndex> make_flann_index(const PointArrays& points);

/// The order of points along a Morton curve of 21 bits an axis through their bounds; points at the same place
/// stand together, in their old order.
std::vector<uint32_t> morton_order(std::span<const glm::dvec3> points);

}  // namespace lucarne::octree
