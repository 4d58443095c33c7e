#include "gi/gather/traced_tree.h"

#include <limits>
#include <utility>

#include "gi/gl_frame.h"

namespace lucarne::gi {

Result<TracedTree> TracedTree::create(const Frame& frame, const LitTree& scene) {
    const SurfelTree& tree = scene.tree();
    TracedTree traced;
    std::vector<Surfel> surfels;
    {  // what was downloaded is freed before Embree needs memory
        std::vector<uint32_t> ids;
        const std::vector<Surfel> downloaded = frame.gl.pool.download(*frame.gl.cuts.light, &ids);
        constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
        std::vector<uint32_t> place_of(scene.surfels().size(), kNone);
        for (uint32_t i = 0; i < ids.size(); ++i)
            if (tracing::has_disc(downloaded[i])) place_of[ids[i]] = i;
        surfels.reserve(downloaded.size());
        for (size_t slot = 0; slot < tree.surfels.size(); ++slot) {
            const uint32_t id = tree.surfels[slot];
            if (id == kNoSurfel || place_of[id] == kNone) continue;
            surfels.push_back(downloaded[place_of[id]]);
            surfels.back().area = tree.areas[slot];
            traced.slot_of.push_back(static_cast<uint32_t>(slot));
            traced.surfel_of.push_back(id);
        }
    }
    LUCARNE_ASSIGN(traced.tracer, tracing::SurfelTracer::create(std::move(surfels)));
    return traced;
}

glm::vec3 ray_start(const tracing::SurfelTracer& tracer, const GatherPoint& point) {
    const glm::vec3 above = tracing::offset_origin(point.position, point.normal, point.lift);
    return tracing::before_what_hides(tracer, above, point.viewer, point.lift);
}

}  // namespace lucarne::gi
