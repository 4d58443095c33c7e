#include "gi/raster/coverage.h"

#include "gi/raster/bindings.h"
#include "gi/raster/native/native.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {

Result<void> find_coverage(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                           const PointSize& size) {
    const size_t pixels = size_t{view.width} * view.height;
    LUCARNE_TRY(device.reserve(target.coverage, pixels * sizeof(uint32_t), "edges"));
    if (native::draws(device, cut))
        return native::find_coverage(cut, view, disc_view(view, size), target.texels, target.ids,
                                     target.coverage);
    LUCARNE_ASSIGN(const Program* program, device.program("gi/raster/coverage.comp"));
    cut.bind();
    target.ids.bind(raster::kBindIds);
    target.coverage.bind(raster::kBindCoverage);
    target.texels.bind_texels(raster::kUnitFront, TexelView::four_words);
    set_disc_view(*program, view, size);
    set(*program, "camera", view);
    program->dispatch(static_cast<uint32_t>(pixels));
    return {};
}

}  // namespace lucarne::gi
