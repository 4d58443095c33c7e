#include "gi/gather/traced_tree.h"

#include <utility>

#include "gi/shared/surfel_code.h"

namespace lucarne::gi {

Result<TracedTree> TracedTree::create(const LitTree& scene) {
    const SurfelTree& tree = scene.tree();
    TracedTree traced;
    std::vector<Surfel> surfels;
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot) {
        if (tree.surfels[slot] == kNoSurfel) continue;
        const FlatSurfel& s = scene.surfels()[tree.surfels[slot]];
        const Surfel surfel{.position = {s.x, s.y, s.z},
                            .normal = decode_octahedral(s.normal),
                            .albedo = decode_albedo(s.albedo),
                            .radius = s.radius,
                            .area = tree.areas[slot],
                            .material = s.material};
        if (!tracing::has_disc(surfel)) continue;
        surfels.push_back(surfel);
        traced.slot_of.push_back(static_cast<uint32_t>(slot));
        traced.surfel_of.push_back(tree.surfels[slot]);
    }
    LUCARNE_ASSIGN(traced.tracer, tracing::SurfelTracer::create(std::move(surfels)));
    return traced;
}

}  // namespace lucarne::gi
