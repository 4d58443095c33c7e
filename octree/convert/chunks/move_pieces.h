#pragma once

#include <cstdint>
#include <span>

#include "io/files/file.h"
#include "octree/cluster/ranks.h"

namespace lucarne::octree {

/// Bytes of a file that go to a place in another rank's file.
struct MovedPiece {
    const ScratchFile* from = nullptr;
    uint64_t offset = 0, bytes = 0;
    size_t rank = 0;
    uint64_t to = 0;  ///< offset in that rank's file
};

/// Sends pieces to the ranks that they are for, and writes those that arrive to `file`, which is to get
/// `expected` bytes. A meeting. `memory`: for messages, bytes. Errors: another number of bytes arrives.
Result<void> move_pieces(Ranks& ranks, std::span<const MovedPiece> pieces, ScratchFile& file,
                         uint64_t expected, uint64_t memory);

}  // namespace lucarne::octree
