#include "gi/vpl/seeding.h"

#include <algorithm>
#include <bit>

#include "gi/gbuffer/uniforms.h"
#include "gi/vpl/bindings.h"
#include "gi/vpl/vpl_light.h"

namespace lucarne::gi::vpl {
namespace {

float luminance(const glm::vec4& rgb) {
    return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}

/// VPLs that do not stand clear in the light (seed.comp) give their flux to the others: the sum stays what
/// lands.
void clear_rims(std::span<VplLight> lights) {
    double all = 0, clear = 0;
    for (const VplLight& l : lights) {
        all += luminance(l.flux);
        if (l.flux.w >= 1) clear += luminance(l.flux);
    }
    const float scale = clear > 0 ? static_cast<float>(all / clear) : 0.0f;
    for (VplLight& l : lights) {
        if (l.flux.w < 1) {
            l = kDeadLight;
            continue;
        }
        for (glm::vec4* flux : {&l.flux, &l.diffuse}) {
            flux->x *= scale;
            flux->y *= scale;
            flux->z *= scale;
        }
    }
}

}  // namespace

Result<void> seed_lights(Device& device, const Light& spot, const CameraView& view, const DeviceCut& cut,
                         const GBuffer& seen, const Buffer& materials, std::span<const glm::vec2> points,
                         Seeds& target) {
    LUCARNE_ASSIGN(const Program* importance, device.program("gi/vpl/importance.comp"));
    LUCARNE_ASSIGN(const Program* mip, device.program("gi/vpl/importance_mip.comp"));
    LUCARNE_ASSIGN(const Program* seed, device.program("gi/vpl/seed.comp"));

    const uint32_t side = std::bit_ceil(std::max({view.width, view.height, 1u}));
    size_t texels = 0;
    for (uint32_t level = side; level > 0; level /= 2) texels += size_t{level} * level;
    const auto count = static_cast<uint32_t>(points.size());
    LUCARNE_TRY(device.reserve(target.importance, texels * sizeof(glm::vec2), "importance map"));
    LUCARNE_TRY(device.reserve(target.points, points.size_bytes(), "Halton points"));
    LUCARNE_TRY(device.reserve(target.lights, count * sizeof(VplLight), "virtual point lights"));
    target.points.upload(0, std::as_bytes(points));

    cut.bind();
    seen.texels.bind(kBindGBuffer);
    seen.ids.bind(kBindLightIds);
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
    seed->set("light_count", count);
    seed->dispatch(count);
    target.host_lights = target.lights.download_all<VplLight>(count);
    clear_rims(target.host_lights);
    target.lights.upload_all(target.host_lights);
    return {};
}

}  // namespace lucarne::gi::vpl
