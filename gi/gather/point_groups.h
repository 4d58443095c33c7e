#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/gather/gather_point.h"

namespace lucarne::gi {

/// The most points that a processor draws at once, in the lanes of its vectors.
inline constexpr size_t kGroupedPoints = 8;
/// The fewest points that are drawn at once. Groups of five and six took longer than their points one by one.
inline constexpr size_t kLeastGroup = 7;

/// Points that are drawn at once.
struct PointGroups {
    std::vector<uint32_t> order;  ///< numbers of all points, group by group
    std::vector<uint32_t> first;  ///< where each group begins in `order`, and the end
    size_t full = 0;  ///< so many groups, the first, are drawn in lanes; the others are single points
};

/// Divides points into groups of up to kGroupedPoints that lie close together and face about the same way.
/// `reach`: how far away what they see usually is, m: axes that differ by an angle are as far apart as points
/// that differ by this angle times `reach`. Groups are full where points are closer than a small part of it.
/// Groups of fewer points than kLeastGroup are taken apart.
PointGroups group_points(std::span<const GatherPoint> points, float reach);

}  // namespace lucarne::gi
