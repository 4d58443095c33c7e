#include "gi/raster/rims.h"

#include "gi/raster/bindings.h"
#include "gi/raster/native/rims.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {

Result<void> turn_rims(Device& device, const CameraView& view, GBuffer& target) {
    if (device.native_passes()) return native::turn_rims(view, target.texels);
    LUCARNE_ASSIGN(const Program* program, device.program("gi/raster/rims.comp"));
    target.texels.bind(raster::kBindTexels);
    set(*program, "camera", view);
    program->dispatch(view.width * view.height);
    return {};
}

}  // namespace lucarne::gi
