#pragma once

#include <optional>
#include <span>
#include <vector>

#include "io/points.h"

namespace lucarne::octree {

/// Rounds the estimated normals and areas of a node to as many bits as their noise deserves: steps of half to
/// the whole median difference between neighbours. Of Gaussian noise that is .48 to .95 of the standard
/// deviation, so rounding adds 2 to 8 % to the variance that is there; calm surfaces keep every bit.
class SurfaceRounding {
 public:
    /// `normals`, `areas`: the attributes of the schema that were estimated; null where there is none.
    SurfaceRounding(const io::Attribute* normals, const io::Attribute* areas, uint32_t stride);
    /// Records along the Morton curve.
    void round(std::span<std::byte> records);

 private:
    void round_normals(std::span<std::byte> records);
    void round_areas(std::span<std::byte> records);
    /// The power of two up to `most` for these differences, which it reorders.
    static int step(std::vector<uint32_t>& differences, int most);

    std::optional<uint32_t> normal_at_, area_at_;  ///< in the record
    uint32_t stride_;
    std::vector<uint32_t> differences_;
};

}  // namespace lucarne::octree
