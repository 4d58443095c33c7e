#pragma once

#include "io/core/error.h"

namespace lucarne::octree {

/// Counting and distributing read the input twice. A file that is written to meanwhile must not corrupt the
/// chunks.
inline auto inputs_changed() {
    return rejected("inputs", "changed while they were read", "convert again when they are complete");
}

}  // namespace lucarne::octree
