#include "gi/lighting/surfel_light.h"

#include "gi/lighting/bindings.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {

Result<void> add_surfel_light(Device& device, const Buffer& surfels, uint32_t count, const LightView& from,
                              const GBuffer& seen, const Buffer& irradiance, const Buffer* directions) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/lighting/surfel_light.comp"));
    seen.texels.bind(lighting::kBindLightTexels);
    surfels.bind(lighting::kBindLitSurfels);
    irradiance.bind(lighting::kBindSurfelIrradiance);
    (directions ? *directions : irradiance).bind(lighting::kBindSurfelDirections);
    program->set("directed", directions ? 1u : 0u);
    program->set("count", count);
    set(*program, "light_view", from.view);
    set(*program, "light", from.light);
    program->set("face", from.face);
    program->dispatch(count);
    return {};
}

}  // namespace lucarne::gi
