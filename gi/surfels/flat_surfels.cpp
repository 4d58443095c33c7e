#include "gi/surfels/flat_surfels.h"

#include "gi/surfels/bindings.h"

namespace lucarne::gi {

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
