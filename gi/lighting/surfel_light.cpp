#include "gi/lighting/surfel_light.h"

#include "gi/lighting/bindings.h"
#include "gi/lighting/native/light.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi {
namespace {

Result<void> add_natively(const Buffer& surfels, uint32_t count, const LightView& from, const GBuffer& seen,
                          const Buffer& irradiance, const Buffer* directions) {
    LUCARNE_ASSIGN(const MappedBuffer flat, surfels.map());
    LUCARNE_ASSIGN(const MappedBuffer shadows, seen.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer sums, irradiance.map());
    native::LitSides lit{flat.as<const FlatSurfel>().first(count), sums.as<float>().data(), nullptr};
    const native::LightShadows by{from.view, shadows.as<const GBufferTexel>().data(), from.face};
    if (!directions) {
        native::add_surfel_light(lit, from.light, by);
        return {};
    }
    LUCARNE_ASSIGN(const MappedBuffer toward, directions->map());
    lit.directions = toward.as<float>().data();
    native::add_surfel_light(lit, from.light, by);
    return {};
}

}  // namespace

Result<void> add_surfel_light(Device& device, const Buffer& surfels, uint32_t count, const LightView& from,
                              const GBuffer& seen, const Buffer& irradiance, const Buffer* directions) {
    if (device.native_passes()) return add_natively(surfels, count, from, seen, irradiance, directions);
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
