#include "gi/surfels/flat_surfels.h"

#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "gi/surfels/bindings.h"

namespace lucarne::gi {

FlatSurfel flat_disc(const Surfel& surfel) {
    const float length2 = glm::dot(surfel.normal, surfel.normal);
    const bool bare = !(length2 > 0.5f && length2 < 2);  // also what is no number
    return {.x = surfel.position.x,
            .y = surfel.position.y,
            .z = surfel.position.z,
            .radius = surfel.radius,
            .area = surfel.area,
            .normal = bare ? 0 : encode_octahedral(surfel.normal),
            .albedo = bare ? 0 : kSurfelHasNormal,
            .material = surfel.material,
            .edge_root = 0};
}

Result<void> flatten(Device& device, const DeviceCut& cut, Buffer& flat) {
    const size_t count = flat_count(cut);
    LUCARNE_TRY(device.reserve(flat, count * sizeof(FlatSurfel), "flat surfels"));
    LUCARNE_ASSIGN(const Program* program, device.program("gi/surfels/flat_surfels.comp"));
    cut.bind();
    flat.bind(kBindFlatSurfels);
    program->set("ids", static_cast<uint32_t>(count));
    program->dispatch(static_cast<uint32_t>(count));
    return {};
}

}  // namespace lucarne::gi
