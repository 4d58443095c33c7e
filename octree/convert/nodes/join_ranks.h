#pragma once

#include <filesystem>

#include "io/files/shared_output.h"
#include "octree/cluster/ranks.h"
#include "octree/convert/nodes/assembler.h"

namespace lucarne::octree {

/// What a rank has built of the nodes.
struct RankNodes {
    const RecordLoader& loader;
    const NodeLimits& limits;
    CacheWriter& staged;
    const Assembler& assembler;  ///< its writer is `staged`
};

/// Puts the nodes of all ranks into one cache, in the order of one process. Rank 0 decides where they go: it
/// assembles the nodes above those of single ranks into `cache` (null at the other ranks) and collects the
/// directory. Then every rank copies its payloads into the file, `output`. Returns the CPU time that this
/// rank spent on compression. A meeting.
Result<double> join_ranks(Ranks& ranks, const RankNodes& nodes, CacheWriter* cache, SharedOutput& output,
                          const std::filesystem::path& temp_folder);

/// Marks the offset of an entry whose payload is in the cache that is updated, and stays where it is.
inline constexpr uint64_t kStays = uint64_t{1} << 63;

/// Does the same where rank 0 alone writes the cache, because it changes one in place: it asks the others for
/// their payloads. A meeting.
Result<void> join_at_first(Ranks& ranks, const RankNodes& nodes, CacheWriter* cache,
                           const std::filesystem::path& temp_folder);

}  // namespace lucarne::octree
