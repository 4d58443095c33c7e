#pragma once

#include <functional>
#include <vector>

#include "octree/normals/orientation/orientation.h"

namespace lucarne::octree {

/// Does what estimate_normals does for the chunks of one process. `orient` receives the votes of each of them
/// on the orientation, in ascending order. Returns messages to chunks of later ranges: the process that has
/// such a chunk turns them into further votes (BorderMessage::heard, with ChunkNormals::site_normals), which
/// come before the chunk's own. OrientationMerger joins the votes of all chunks.
Result<std::vector<BorderMessage>> estimate_range(
    const ChunkAccess& chunks, ChunkRange range, const NormalOptions& options,
    const std::function<Result<void>(size_t chunk, ChunkNormals&&)>& sink,
    const std::function<void(ChunkVotes&&)>& orient);

}  // namespace lucarne::octree
