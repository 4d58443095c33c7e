#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::octree {

/// Keeps runs of consecutive points of one scan, evenly spread over the file. Memory does not grow with the
/// scan (kMostRuns). The runs depend on the order of the points alone, not on how they come in batches.
class ScanRuns {
 public:
    static constexpr size_t kRunPoints = 64, kMostRuns = 4096;

    ScanRuns() = default;
    /// For a part of a scan of `points` points, from point `first` on, with those runs that a scan of so many
    /// points keeps. `origin`: the scan's first point.
    ScanRuns(uint64_t first, uint64_t points, const glm::dvec3& origin);

    /// Adds the scan's next points: records of `schema`.
    void add(const io::Schema& schema, std::span<const std::byte> records);

    /// Number of complete runs.
    size_t count() const { return points_.size() / kRunPoints; }
    /// The points of a run, relative to origin().
    std::span<const glm::vec3> run(size_t index) const {
        return {points_.data() + index * kRunPoints, kRunPoints};
    }
    /// All points that are kept, also those of an incomplete run at the end; or at the start of a part.
    std::span<const glm::vec3> kept() const { return points_; }
    /// Adds the `count` points of the part behind this one, which has kept `points`.
    void join(std::span<const glm::vec3> points, uint64_t count);
    /// The index of a run's first point in the scan.
    uint64_t first_point(size_t index) const { return index * stride_ * kRunPoints; }
    /// Number of points added so far.
    uint64_t points() const { return seen_; }
    /// The scan's first point.
    const glm::dvec3& origin() const { return origin_; }

 private:
    void halve();

    glm::dvec3 origin_{0.0};
    std::vector<glm::vec3> points_;
    uint64_t seen_ = 0;    ///< points
    uint64_t stride_ = 1;  ///< of the runs that are kept
};

}  // namespace lucarne::octree
