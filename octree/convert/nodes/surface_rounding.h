#pragma once

#include <optional>
#include <span>
#include <vector>

#include "io/points.h"
#include "octree/tree/edge_line.h"
#include "octree/tree/point_normals.h"

namespace lucarne::octree {

/// Rounds the estimated normals and areas of a node to as many bits as their noise justifies: to steps of
/// half to the whole median difference between neighbours. For Gaussian noise that is .48 to .95 of the
/// standard deviation, so rounding adds 2 to 8 % to the variance that is already there. Smooth surfaces keep
/// every bit.
class SurfaceRounding {
 public:
    explicit SurfaceRounding(const io::Schema& schema);
    /// Rounds the records of a node, which must be in order along the Morton curve. The lines of points at
    /// edges stay where they are.
    void round(std::span<std::byte> records);

 private:
    void round_normals(std::span<std::byte> records);
    void round_areas(std::span<std::byte> records);
    /// Returns the step for these differences, a power of two up to `most`. Reorders the differences.
    static int step(std::vector<uint32_t>& differences, int most);

    EdgeBase base_of(const std::byte* record) const;  ///< areas in faces of the first root cube

    PointNormals drawn_normals_;
    std::optional<uint32_t> normal_at_, area_at_, edge_at_;  ///< in the record
    uint32_t stride_;
    std::vector<uint32_t> differences_;
    std::vector<EdgeBase> bases_;  ///< of the points with lines, in order
};

}  // namespace lucarne::octree
