#pragma once

#include "gi/shared/flat_surfel.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {

/// Returns the number of ids of a cut, gaps between blocks included.
inline size_t flat_count(const DeviceCut& cut) {
    return size_t{cut.blocks()} * kBlockSurfels;
}

/// Returns place, size and normal of a surfel on the host, without its colour. What is no unit vector is no
/// normal.
FlatSurfel flat_disc(const Surfel& surfel);

/// Decodes the cut's surfels into flat_count(cut) FlatSurfels, for devices other than OpenGL. `flat` grows
/// as needed. Errors: device memory.
Result<void> flatten(Device& device, const DeviceCut& cut, Buffer& flat);

}  // namespace lucarne::gi
