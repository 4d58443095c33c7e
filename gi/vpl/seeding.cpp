#include "gi/vpl/seeding.h"

#include <algorithm>
#include <bit>

#include "gi/gbuffer/uniforms.h"
#include "gi/vpl/bindings.h"
#include "gi/vpl/vpl_light.h"

namespace lucarne::gi::vpl {

Result<void> seed_lights(Device& device, const SpotLight& spot, const CameraView& view, const GBuffer& seen,
                         const Buffer& materials, std::span<const glm::vec2> points, Seeds& target) {
    LUCARNE_ASSIGN(const Program* importance, device.program("gi/vpl/importance.comp"));
    LUCARNE_ASSIGN(const Program* mip, device.program("gi/vpl/importance_mip.comp"));
    LUCARNE_ASSIGN(const Program* seed, device.program("gi/vpl/seed.comp"));

    const uint32_t side = std::bit_ceil(std::max({view.width, view.height, 1u}));
    size_t texels = 0;
    for (uint32_t level = side; level > 0; level /= 2) texels += size_t{level} * level;
    const auto padded = static_cast<uint32_t>((points.size() + kRunMaps - 1) / kRunMaps * kRunMaps);
    LUCARNE_TRY(device.reserve(target.importance, texels * sizeof(glm::vec2), "importance map"));
    LUCARNE_TRY(device.reserve(target.points, points.size_bytes(), "Halton points"));
    LUCARNE_TRY(device.reserve(target.lights, padded * sizeof(VplLight), "virtual point lights"));
    target.points.upload(0, std::as_bytes(points));

    seen.texels.bind(kBindGBuffer);
    materials.bind(kBindMaterials);
    target.points.bind(kBindPoints);
    target.importance.bind(kBindImportance);
    target.lights.bind(kBindLights);
    for (const Program* program : {importance, mip, seed}) {
        program->set("importance_side", side);
        set(*program, "light_view", view);
        set(*program, "spot", spot);
    }
    importance->dispatch(side, side);
    for (uint32_t level = 1; side >> level > 0; ++level) {
        mip->set("level", level);
        mip->dispatch(side >> level, side >> level);
    }
    seed->set("light_count", static_cast<uint32_t>(points.size()));
    seed->dispatch(padded);
    return {};
}

}  // namespace lucarne::gi::vpl
