#pragma once

#include "octree/tree/source.h"

namespace lucarne::octree {

/// The schema of synthetic surfels: position, colour (u8, sRGB), normal_oct, area. Positions are as fine as a
/// root cube's lattice allows.
io::Schema filling_schema(const Cube& root);

/// Groups a cache's synthetic surfels by cubes of one level: the coarsest in whose cubes 16 bits a coordinate
/// resolve a sixteenth of their spacing, but not so fine that there are more than a few hundred cubes. `data`
/// has the schema of header.filling.
Filling grouped_filling(const SourceHeader& header, const NodeData& data);

}  // namespace lucarne::octree
