#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::octree {

struct Neighbour {
    double distance2 = 0;  ///< squared distance to the query
    uint32_t index = 0;
};

/// Nearest neighbours among points held in double precision: FLANN's single kd-tree. Measured: double costs
/// no more than float here, and needs no local origin at projected coordinates. Searching is thread-safe.
class PointIndex {
 public:
    PointIndex();  ///< of no points
    /// `points` must be finite, under kLargestCoordinate, and outlive the index.
    explicit PointIndex(std::span<const glm::dvec3> points);
    PointIndex(PointIndex&&) noexcept;
    PointIndex& operator=(PointIndex&&) noexcept;
    ~PointIndex();

    /// Merges this index' points into `nearest`, whose first `found` entries are sorted by distance already;
    /// an index of the result is the point's plus `offset`. Points as far as the root of `limit2` are left
    /// out. Returns how many entries are filled now.
    size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found, uint32_t offset,
                         double limit2 = std::numeric_limits<double>::max()) const;
    /// The same of only those points that `wanted` (asked with the point's index) lets through.
    using Wanted = std::function<bool(uint32_t index)>;
    size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found, uint32_t offset,
                         double limit2, const Wanted& wanted) const;

    /// Squares of larger coordinates would overflow inside the search.
    static constexpr double kLargestCoordinate = 1e150;

 private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace lucarne::octree
