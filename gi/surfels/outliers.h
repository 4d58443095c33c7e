#pragma once

#include <cstdint>
#include <vector>

#include "gi/shared/surfel.h"

namespace lucarne::gi {

/// How strict the choice of outliers is (Look::outliers).
inline constexpr uint32_t kDrawOutliers = 0;   ///< draws also what the converter found
inline constexpr uint32_t kFoundOutliers = 1;  ///< leaves out what the converter found

/// Marks further surfels of a node as outliers (kStrayArea), or makes outliers visible: `found` holds the
/// indices of those that the converter found. Each surfel is compared with its neighbours in the node. From 2
/// on are left out: discs over four times as large as those of their neighbours, if these do not lie in their
/// plane, or cover the place without them; points without a normal that are twice as large, or whose
/// neighbours have one. At 3 also: all other discs over four times as large; all points without a normal.
/// Clouds of which most points have no normal keep all. At 0 outliers are drawn with the node's median share.
void choose_outliers(uint32_t strictness, const std::vector<uint32_t>& found,
                     std::vector<PackedSurfel>& surfels);

}  // namespace lucarne::gi
