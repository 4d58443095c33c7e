#pragma once

#include "gi/shared/flat_surfel.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {

/// How many ids the cut has, gaps between blocks included.
inline size_t flat_count(const DeviceCut& cut) {
    return size_t{cut.blocks()} * kBlockSurfels;
}

/// Decodes the cut's surfels into flat_count(cut) FlatSurfels: what leaves OpenGL for other devices. `flat`
/// grows as needed. Errors: device memory.
Result<void> flatten(Device& device, const DeviceCut& cut, Buffer& flat);

}  // namespace lucarne::gi
