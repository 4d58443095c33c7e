#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/shared/flat_surfel.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi {

/// Places between which light is exchanged: surfels that gather on both sides for those about them.
struct Places {
    std::vector<uint32_t> surfels;  ///< by place: the surfel that gathers
    std::vector<uint32_t> slots;    ///< by place: the node of the tree from which it was drawn
};

/// Chooses at most `most` places, which is at least 8. Each is drawn in proportion to area from a node whose
/// surfels are close together and nearly coplanar. The same tree and seed give the same places.
Places choose_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels, size_t most, uint64_t seed);

/// Returns for each side of each surfel (2 * surfel + 1: its back) the side of a place that gathers for it
/// (2 * place + 1: the back of the place's surfel); kNoSurfel where it has no disc. It is that of the place
/// that is nearest along their common plane, of those drawn from nodes about its own: where a node joins a
/// wall with the pane of a window in it, the one that was drawn does not stand for the other. `nearness`: for
/// each side of places the mean of 1 over the distance of what it sees, 1/m. Light changes within the
/// harmonic mean distance (Ward et al. 1988, "A ray tracing solution for diffuse interreflection"), so a side
/// that is within less than a node of other things counts as that much further away. Most of these lie
/// within something, where nobody sees their light. The same for any number of threads.
std::vector<uint32_t> assign_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                                    const Places& places, std::span<const float> nearness);

}  // namespace lucarne::gi
