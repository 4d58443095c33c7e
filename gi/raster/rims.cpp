#include "gi/raster/rims.h"

#include <glm/vec4.hpp>

#include "gi/raster/bindings.h"
#include "gi/raster/native/rims.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {
namespace {

const Defines kApply = {{"LUCARNE_APPLY", "1"}};

}  // namespace

Result<void> turn_rims(Device& device, const CameraView& view, GBuffer& target) {
    if (device.native_passes()) return native::turn_rims(view, target.texels, target.ids);
    const size_t pixels = size_t{view.width} * view.height;
    LUCARNE_TRY(device.reserve(target.coverage, pixels * sizeof(glm::uvec4), "edges"));
    LUCARNE_ASSIGN(const Program* find, device.program("gi/raster/rims.comp"));
    LUCARNE_ASSIGN(const Program* apply, device.program("gi/raster/rims.comp", kApply));
    target.texels.bind(raster::kBindTexels);
    target.ids.bind(raster::kBindIds);
    target.coverage.bind(raster::kBindCoverage);
    for (const Program* program : {find, apply}) {
        set(*program, "camera", view);
        program->dispatch(static_cast<uint32_t>(pixels));
    }
    return {};
}

}  // namespace lucarne::gi
