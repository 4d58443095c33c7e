#include "gi/engines/vpl/view_importance/view_importance.h"

#include <algorithm>
#include <array>
#include <utility>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/raster/uniforms.h"
#include "gi/shared/luminance.h"
#include "io/core/random.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kCells = 8;  // importons along a side of the picture
constexpr uint32_t kMapSide = 64;
constexpr double kByLightAlone = 0.1;  // share of the VPLs

/// Returns the light that leaves a candidate, W/sr along its normal, lobes counted like diffuse light.
double leaving(const VplLight& light) {
    return luminance(glm::vec3(light.diffuse)) + light.incident.w * luminance(glm::vec3(light.flux));
}

/// Returns the median distance of the importons from the camera, m; 0 if there are none.
float median_distance(const CameraView& camera, const std::vector<VplLight>& importons) {
    std::vector<float> distances;
    for (const VplLight& importon : importons)
        if (importon.flux.w > 0)
            distances.push_back(glm::distance(glm::vec3(importon.position), glm::vec3(camera.origin)));
    if (distances.empty()) return 0;
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

}  // namespace

bool ViewImportance::serves(const CameraView& camera) const {
    constexpr float kMoved = 0.2f, kTurned = 0.94f;  // 20 degrees
    return glm::distance(glm::vec3(camera.origin), glm::vec3(camera_.origin)) <= kMoved * distance_ &&
           glm::dot(glm::vec3(camera.forward), glm::vec3(camera_.forward)) >= kTurned;
}

Result<void> ViewImportance::add(Frame& frame, const Seeds& importons, const Seeds& candidates,
                                 uint32_t count, bool sources, ShadowMaps& maps) {
    Device& device = frame.gl.device;
    LUCARNE_ASSIGN(const Program* gather, device.program("gi/engines/vpl/view_importance/measure.comp"));
    LUCARNE_ASSIGN(const AtlasLayout layout, atlas_layout(kCells * kMapSide, kCells * kCells));
    LUCARNE_TRY(
        draw_shadow_maps(device, *frame.gl.cuts.light, importons, layout, sources, frame.times, maps));
    importons.lights.bind_texels(kUnitLights, TexelView::four_words);
    maps.atlas.bind_texels(kUnitAtlas, TexelView::one_word);
    candidates.lights.bind(kBindLights);
    sums_.bind(kBindViewImportance);
    set_layout(*gather, layout);
    gather->set("footprint_variance", footprint_variance(0));
    gather->set("candidate_count", count);
    gather->set("importon_count", layout.maps);
    gather->dispatch(count);
    return {};
}

Result<void> ViewImportance::measure(Frame& frame, const Buffer& materials, uint64_t seed,
                                     const Seeds& candidates, uint32_t count, ShadowMaps& maps) {
    Device& device = frame.gl.device;
    LUCARNE_ASSIGN(const Program* place, device.program("gi/engines/vpl/view_importance/importons.comp"));
    constexpr uint32_t kImportons = kCells * kCells;
    LUCARNE_TRY(device.reserve(importons_.lights, kImportons * sizeof(VplLight), "importons"));
    LUCARNE_TRY(device.reserve(sums_, count * sizeof(float), "importance of VPLs"));
    sums_.clear(0);
    materials.bind(kBindMaterials);
    frame.gl.gbuffer.texels.bind(kBindGBuffer);
    importons_.lights.bind(kBindLights);
    set(*place, "camera", frame.camera);
    Random random(seed, count);
    const float x = static_cast<float>(random.uniform()), y = static_cast<float>(random.uniform());
    place->set("cells", kCells);
    place->set_block("shift", std::array{x, y});
    place->dispatch(kImportons);
    std::swap(maps.atlas, atlas_);
    const auto both = [&]() -> Result<void> {
        LUCARNE_TRY(add(frame, importons_, candidates, count, true, maps));
        redistribution_.footprint_variance = footprint_variance(0);
        LUCARNE_TRY(redistribute(device, *frame.gl.cuts.light, maps, materials, false,
                                 static_cast<uint32_t>(seed), importons_, redistribution_, second_));
        return add(frame, second_, candidates, count, false, maps);
    }();
    std::swap(maps.atlas, atlas_);
    LUCARNE_TRY(both);
    importance_ = sums_.download_all<float>(count);
    camera_ = frame.camera;
    distance_ = median_distance(frame.camera, importons_.lights.download_all<VplLight>(kImportons));
    return {};
}

std::vector<VplLight> draw_candidates(std::span<const VplLight> candidates, std::span<const float> importance,
                                      uint32_t count, uint64_t seed) {
    std::vector<double> weights(candidates.size());
    double light_sum = 0, weight_sum = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
        const double light = leaving(candidates[i]);
        weights[i] = importance[i] > 0 ? light * static_cast<double>(importance[i]) : 0;  // NaN: 0
        light_sum += light;
        weight_sum += weights[i];
    }
    std::vector<VplLight> drawn(count, kDeadLight);
    if (!(light_sum > 0)) return drawn;
    const double alone = weight_sum > 0 ? kByLightAlone : 1;
    const double offset = Random(seed, candidates.size()).uniform();
    double running = 0;  // expected number of VPLs drawn up to here
    uint32_t next = 0;
    for (size_t i = 0; i < candidates.size() && next < count; ++i) {
        const double probability = alone * leaving(candidates[i]) / light_sum +
                                   (weight_sum > 0 ? (1 - alone) * weights[i] / weight_sum : 0);
        const double expected = count * probability;
        running += expected;
        for (; next < count && next + offset < running; ++next) {
            VplLight light = candidates[i];
            const auto scale = static_cast<float>(1 / expected);
            light.position.w *= scale;
            for (glm::vec4* energy : {&light.diffuse, &light.flux})
                for (int channel = 0; channel < 3; ++channel) (*energy)[channel] *= scale;
            drawn[next] = light;
        }
    }
    return drawn;
}

}  // namespace lucarne::gi::vpl
