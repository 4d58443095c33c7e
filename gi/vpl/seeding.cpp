#include "gi/vpl/seeding.h"

#include <algorithm>
#include <bit>

#include "gi/vpl/bindings.h"
#include "gi/vpl/vpl_light.h"

namespace lucarne::gi::vpl {

Result<void> seed_lights(Device& device, const GBuffer& light_gbuffer, std::span<const glm::vec2> points,
                         Seeds& target) {
    LUCARNE_ASSIGN(const Program* importance, device.program("gi/vpl/importance.comp"));
    LUCARNE_ASSIGN(const Program* mip, device.program("gi/vpl/importance_mip.comp"));
    LUCARNE_ASSIGN(const Program* seed, device.program("gi/vpl/seed.comp"));

    const uint32_t side = std::bit_ceil(std::max({light_gbuffer.width, light_gbuffer.height, 1u}));
    size_t texels = 0;
    for (uint32_t level = side; level > 0; level /= 2) texels += size_t{level} * level;
    LUCARNE_TRY(device.reserve(target.importance, texels * sizeof(glm::vec2), "importance map"));
    LUCARNE_TRY(device.reserve(target.points, points.size_bytes(), "Halton points"));
    LUCARNE_TRY(device.reserve(target.lights, points.size() * sizeof(VplLight), "virtual point lights"));
    target.points.upload(0, std::as_bytes(points));

    light_gbuffer.texels.bind(kBindGBuffer);
    target.points.bind(kBindPoints);
    target.importance.bind(kBindImportance);
    target.lights.bind(kBindLights);
    importance->set("importance_side", side);
    importance->dispatch(side, side);
    mip->set("importance_side", side);
    for (uint32_t level = 1; side >> level > 0; ++level) {
        mip->set("level", level);
        mip->dispatch(side >> level, side >> level);
    }
    seed->set("importance_side", side);
    seed->set("light_count", static_cast<uint32_t>(points.size()));
    seed->dispatch(static_cast<uint32_t>(points.size()));
    return {};
}

}  // namespace lucarne::gi::vpl
