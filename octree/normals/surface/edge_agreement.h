#pragma once

#include "octree/normals/surface/chunk_surface.h"

namespace lucarne::octree {

/// Makes the lines of sites along one edge agree: each site takes the median of its own line and of those of
/// its neighbours in the graph, where these run alike, and sites beside them get a line that they lack. Only
/// sites whose planes are alike take part. Lines stay sorted by site.
void agree_on_lines(const ChunkNeighbours& neighbours, ChunkSurface& surface);

}  // namespace lucarne::octree
