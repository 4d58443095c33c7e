#include "gi/gather/traced_tree.h"

#include <utility>

#include "gi/gl_frame.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi {

Result<TracedTree> TracedTree::create(const Frame& frame, const LitTree& scene) {
    const SurfelTree& tree = scene.tree();
    TracedTree traced;
    // One copy of the surfels at a time, in the order of the slots: they take more memory than all else here.
    std::vector<uint32_t> place_of(scene.surfels().size(), kNoSurfel);
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot) {
        const uint32_t id = tree.surfels[slot];
        if (id == kNoSurfel) continue;
        place_of[id] = static_cast<uint32_t>(traced.slot_of.size());
        traced.slot_of.push_back(static_cast<uint32_t>(slot));
        traced.surfel_of.push_back(id);
    }
    std::vector<Surfel> surfels(traced.slot_of.size());
    frame.gl.pool.each_surfel(*frame.gl.cuts.light, [&](uint32_t id, const Surfel& surfel) {
        const uint32_t place = place_of[id];
        if (place == kNoSurfel) return;
        surfels[place] = surfel;
        surfels[place].area = tree.areas[traced.slot_of[place]];
        if (surfel.normal == glm::vec3(0.0f))  // that of the plane about it
            surfels[place].normal = decode_octahedral(scene.surfels()[id].normal);
    });
    size_t kept = 0;
    for (size_t i = 0; i < surfels.size(); ++i) {
        if (!tracing::has_disc(surfels[i])) continue;
        surfels[kept] = surfels[i];
        traced.slot_of[kept] = traced.slot_of[i];
        traced.surfel_of[kept++] = traced.surfel_of[i];
    }
    surfels.resize(kept);
    traced.slot_of.resize(kept);
    traced.surfel_of.resize(kept);
    LUCARNE_ASSIGN(traced.tracer, tracing::SurfelTracer::create(std::move(surfels)));
    return traced;
}

glm::vec3 ray_start(const tracing::SurfelTracer& tracer, const GatherPoint& point) {
    const glm::vec3 above = tracing::offset_origin(point.position, point.normal, point.lift);
    return tracing::before_what_hides(tracer, above, point.viewer, point.normal, point.lift);
}

}  // namespace lucarne::gi
