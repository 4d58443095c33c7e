#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/shared/flat_surfel.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi {

/// Places between which light is exchanged: surfels that gather for those about them.
struct Places {
    std::vector<uint32_t> surfels;   ///< by place: the surfel that gathers
    std::vector<uint32_t> place_of;  ///< by surfel: its place; kNoSurfel: it has no disc
};

/// Chooses at most `most` places, which is at least 8. Each is drawn in proportion to area
/// from a node whose surfels are close together and nearly coplanar. A surfel belongs to the place that is
/// nearest to it along their common plane, of those drawn from nodes about its own: where a node joins a wall
/// with the pane of a window in it, the one that was drawn does not stand for the other.
/// The same tree and seed give the same places, whatever the number of threads.
Places choose_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels, size_t most, uint64_t seed);

}  // namespace lucarne::gi
