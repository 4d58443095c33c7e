#include "gi/engines/vpl/seeding/seeding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/seeding/halton.h"
#include "gi/engines/vpl/seeding/native/importance.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/raster/uniforms.h"
#include "gi/shared/luminance.h"

namespace lucarne::gi::vpl {
namespace {

// VPLs before and after one on the curve of Halton points (halton.h): its neighbours in the light's view.
constexpr size_t kNeighbours = 256;

bool clear(const VplLight& light) {
    return light.flux.w >= 1;
}

double power(const VplLight& light) {
    return luminance(glm::vec3(light.flux));
}

/// Returns the nearest clear VPL around index `i` whose surface faces the same way; null if there is none.
VplLight* nearest_clear(std::span<VplLight> lights, size_t i) {
    VplLight* nearest = nullptr;
    float least = INFINITY;
    const size_t end = std::min(i + kNeighbours + 1, lights.size());
    for (size_t k = i > kNeighbours ? i - kNeighbours : 0; k < end; ++k) {
        VplLight& other = lights[k];
        if (!clear(other) || !(power(other) > 0)) continue;
        if (glm::dot(glm::vec3(other.normal), glm::vec3(lights[i].normal)) < kSameSurface) continue;
        const glm::vec3 offset(other.position - lights[i].position);
        const float distance2 = glm::dot(offset, offset);
        if (distance2 < least) least = distance2, nearest = &other;
    }
    return nearest;
}

/// Removes VPLs that are not wholly in the light (seed.comp). Those at the border of a patch of light give
/// their flux to the nearest VPL of the same surface, else to all, so that each patch keeps its light: sun
/// through a window lights a patch with a long border, while roofs have hardly any. The flux of stray rims is
/// dropped: the rims of outer walls stick out above the roof, and the nearest VPL that faces the same way may
/// be behind a window, in a room that would get as much light again.
void clear_rims(std::span<VplLight> lights) {
    std::vector<double> received(lights.size());  // W
    double all = 0, unassigned = 0;
    for (size_t i = 0; i < lights.size(); ++i) {
        if (lights[i].flux.w == kStray) continue;
        all += power(lights[i]);
        if (clear(lights[i]) || !(power(lights[i]) > 0)) continue;
        if (const VplLight* nearest = nearest_clear(lights, i))
            received[static_cast<size_t>(nearest - lights.data())] += power(lights[i]);
        else
            unassigned += power(lights[i]);
    }
    const double shared = all > unassigned ? all / (all - unassigned) : 0.0;
    for (size_t i = 0; i < lights.size(); ++i) {
        VplLight& l = lights[i];
        if (!clear(l)) {
            l = kDeadLight;
            continue;
        }
        const double own = power(l), grown = own > 0 ? 1 + received[i] / own : 1.0;
        l.position.w *= static_cast<float>(grown);
        for (glm::vec4* flux : {&l.flux, &l.diffuse})
            for (int channel = 0; channel < 3; ++channel)
                (*flux)[channel] *= static_cast<float>(grown * shared);
    }
}

uint32_t importance_side(const CameraView& view) {
    return std::bit_ceil(std::max({view.width, view.height, 1u}));
}

void set_light_view(const Program& program, const LightGBuffer& gbuffer) {
    program.set("importance_side", importance_side(gbuffer.view));
    set(program, "light_view", gbuffer.view);
    set(program, "light", gbuffer.light);
    program.set("face", gbuffer.face);
}

}  // namespace

namespace {

Result<void> map_by_shaders(Device& device, const LightGBuffer& gbuffer, const Buffer& materials,
                            uint32_t side, const Buffer& target) {
    materials.bind(kBindMaterials);
    LUCARNE_ASSIGN(const Program* importance, device.program("gi/engines/vpl/seeding/importance.comp"));
    LUCARNE_ASSIGN(const Program* mip, device.program("gi/engines/vpl/seeding/importance_mip.comp"));
    gbuffer.seen.texels.bind(kBindGBuffer);
    target.bind(kBindImportance);
    set_light_view(*importance, gbuffer);
    set_light_view(*mip, gbuffer);
    importance->dispatch(side, side);
    for (uint32_t level = 1; side >> level > 0; ++level) {
        mip->set("level", level);
        mip->dispatch(side >> level, side >> level);
    }
    return {};
}

Result<void> map_natively(const LightGBuffer& gbuffer, const Buffer& materials, uint32_t side,
                          const Buffer& target) {
    LUCARNE_ASSIGN(const MappedBuffer of_surfels, materials.map());
    LUCARNE_ASSIGN(const MappedBuffer texels, gbuffer.seen.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer levels, target.map());
    native::map_importance({.light = gbuffer.light,
                            .face = gbuffer.face,
                            .view = gbuffer.view,
                            .texels = texels.as<const GBufferTexel>().data(),
                            .materials = of_surfels.as<const Material>(),
                            .side = side},
                           levels.as<glm::vec2>());
    return {};
}

}  // namespace

Result<double> map_importance(Device& device, const LightGBuffer& gbuffer, const Buffer& materials,
                              bool glossy, Buffer& target) {
    const uint32_t side = importance_side(gbuffer.view);
    size_t texels = 0;
    for (uint32_t level = side; level > 0; level /= 2) texels += size_t{level} * level;
    LUCARNE_TRY(device.reserve(target, texels * sizeof(glm::vec2), "importance map"));
    LUCARNE_TRY(device.native_passes() && !glossy ? map_natively(gbuffer, materials, side, target)
                                                  : map_by_shaders(device, gbuffer, materials, side, target));
    glm::vec2 sum;
    target.download((texels - 1) * sizeof(glm::vec2), std::as_writable_bytes(std::span(&sum, 1)));
    // If all is black but something is lit, VPLs are placed there evenly: surfaces may be glossy at some
    // wavelength.
    return sum.x > 0 ? sum.x : sum.y > 0 ? 1e-30 : 0.0;
}

Result<void> seed_view(Device& device, const LightGBuffer& gbuffer, const Buffer& importance,
                       const Buffer& materials, std::span<const glm::vec2> points, uint32_t first,
                       Seeds& target) {
    LUCARNE_ASSIGN(const Program* seed, device.program("gi/engines/vpl/seeding/seed.comp"));
    LUCARNE_TRY(device.reserve(target.points, points.size_bytes(), "Halton points"));
    target.points.upload(0, std::as_bytes(points));
    gbuffer.cut.bind();
    gbuffer.seen.texels.bind(kBindGBuffer);
    gbuffer.seen.ids.bind(kBindLightIds);
    materials.bind(kBindMaterials);
    importance.bind(kBindImportance);
    target.points.bind(kBindPoints);
    target.lights.bind(kBindLights);
    set_light_view(*seed, gbuffer);
    seed->set("first_light", first);
    seed->set("light_count", static_cast<uint32_t>(points.size()));
    seed->dispatch(static_cast<uint32_t>(points.size()));
    return {};
}

std::vector<uint32_t> share_out(std::span<const double> weights, uint32_t count) {
    double sum = 0;
    for (const double w : weights) sum += w;
    std::vector<uint32_t> shares(weights.size(), 0);
    if (!(sum > 0)) return shares;
    // Every light with a weight gets one VPL; the rest are assigned where the running sum crosses whole
    // numbers.
    uint32_t left = count;
    for (size_t i = 0; i < weights.size() && left > 0; ++i)
        if (weights[i] > 0) shares[i] = 1, --left;
    const uint32_t free = left;
    double running = 0;
    uint32_t given = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        running += weights[i];
        const auto upto = static_cast<uint32_t>(std::floor(running / sum * free + 0.5));
        shares[i] += upto - given;
        given = upto;
    }
    return shares;
}

double leaving_light(const VplLight& light) {
    return luminance(glm::vec3(light.diffuse)) + light.incident.w * luminance(glm::vec3(light.flux));
}

void settle_lights(Seeds& seeds, uint32_t count) {
    seeds.host_lights = seeds.lights.download_all<VplLight>(count);
    clear_rims(seeds.host_lights);
    seeds.lights.upload_all(seeds.host_lights);
}

}  // namespace lucarne::gi::vpl
