#pragma once

#include <optional>
#include <span>
#include <vector>

#include "io/points.h"

namespace lucarne::octree {

/// Rounds the estimated normals and areas of a node to as many bits as their noise justifies: to steps of
/// half to the whole median difference between neighbours. For Gaussian noise that is .48 to .95 of the
/// standard deviation, so rounding adds 2 to 8 % to the variance that is already there. Smooth surfaces keep
/// every bit.
class SurfaceRounding {
 public:
    /// `normals`, `areas`: the estimated attributes of the schema; null if there are none.
    SurfaceRounding(const io::Attribute* normals, const io::Attribute* areas, uint32_t stride);
    /// Rounds the records of a node, which must be in order along the Morton curve.
    void round(std::span<std::byte> records);

 private:
    void round_normals(std::span<std::byte> records);
    void round_areas(std::span<std::byte> records);
    /// Returns the step for these differences, a power of two up to `most`. Reorders the differences.
    static int step(std::vector<uint32_t>& differences, int most);

    std::optional<uint32_t> normal_at_, area_at_;  ///< in the record
    uint32_t stride_;
    std::vector<uint32_t> differences_;
};

}  // namespace lucarne::octree
