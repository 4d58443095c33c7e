#pragma once

#include <optional>
#include <span>

#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Counts the points for the chunk plan while their bounds are found, which saves a pass over the inputs. The
/// cells are those of the root cube, which depends on the true bounds. Here the cube of the boxes that the
/// inputs' headers state stands in for it. A header may be wrong, so the counts are used only if both cubes
/// are equal.
class EarlyCount {
 public:
    /// `grid_bytes`: MemoryPlan::grid_bytes. Counts nothing if an input with points states no box.
    EarlyCount(const Unifier& inputs, uint64_t grid_bytes);

    /// Counts records of the unified schema. `min` and `max` bound them; they may bound earlier ones as well.
    /// Stops counting if a point is outside the cube.
    void add(const io::Schema& schema, std::span<const std::byte> records, const glm::dvec3& min,
             const glm::dvec3& max);
    /// Returns the counts of all points, in the grid that CountGrid makes for the root cube and the number of
    /// points of `facts`. Empty if the headers stated another cube or too few points.
    std::optional<CountGrid> take(const ScanFacts& facts);

 private:
    uint64_t grid_bytes_;
    Cube cube_;
    std::optional<CountGrid> grid_;  ///< empty: a separate pass has to count
};

}  // namespace lucarne::octree
