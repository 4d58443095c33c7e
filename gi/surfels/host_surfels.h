#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi {

class DeviceCut;

/// Where the surfels of a block are.
struct BlockBounds {
    glm::vec3 low, high;  ///< of the centres, metres relative to the local origin
    float radius;         ///< of the largest disc, m; 0: the block has no surfel to draw
};

/// What passes in C++ read of a cut besides its packed surfels.
struct HostSurfels {
    /// Radii are stored block by block, each padded to a multiple of this, so that vectors may read over the
    /// end.
    static constexpr uint32_t kPadding = 16;
    /// The discs' radii, m, before the look's scale. 0 for outliers, clipped surfels and paddings.
    std::vector<float> radii;
    std::vector<uint32_t> first;  ///< by block: the place of its first radius
    std::vector<BlockBounds> bounds;
};

/// Computes radii and bounds. `pool` is the memory of the cut's pool.
HostSurfels host_surfels(const DeviceCut& cut, std::span<const PackedSurfel> pool);

}  // namespace lucarne::gi
