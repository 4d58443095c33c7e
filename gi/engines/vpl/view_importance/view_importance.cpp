#include "gi/engines/vpl/view_importance/view_importance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/lobes.h"
#include "gi/engines/vpl/view_importance/openings.h"
#include "gi/lighting/sky_grid.h"
#include "gi/raster/uniforms.h"
#include "io/core/random.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kCells = 8;  // importons along a side of the picture
constexpr uint32_t kImportons = kCells * kCells;
constexpr uint32_t kMapSide = 64;
constexpr uint64_t kPlacing = 8192;  // stream of random numbers
// Shares of the VPLs. Those chosen by nearness stand where no importon sees them, but where a pixel may.
constexpr double kByLightAlone = 0.1, kByNearness = 0.2;

Result<AtlasLayout> importon_layout() {
    return atlas_layout(kCells * kMapSide, kImportons);
}

/// Returns the sums of openings.comp, each shared out among its cell and the eight around it: places between
/// the importons see an opening in directions between theirs.
std::vector<float> spread(const std::vector<uint32_t>& sums) {
    std::vector<float> shares(kSkyCells);
    for (uint32_t cell = 0; cell < kSkyCells; ++cell)
        for (uint32_t step = 0; step < 9; ++step) {
            const uint32_t row = std::clamp(cell / kSkyColumns + step / 3, 1u, kSkyRows) - 1;
            const uint32_t column = (cell + kSkyColumns - 1 + step % 3) % kSkyColumns;
            shares[row * kSkyColumns + column] += static_cast<float>(sums[cell]) / (9 * kOpeningSteps);
        }
    return shares;
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

/// Returns the light of the candidates times a factor each, divided by the sum; nothing if all are 0.
std::vector<double> weighted(std::span<const VplLight> candidates, std::span<const float> factors) {
    std::vector<double> weights(candidates.size());
    double sum = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
        weights[i] =
            factors[i] > 0 ? leaving_light(candidates[i]) * static_cast<double>(factors[i]) : 0;  // NaN: 0
        sum += weights[i];
    }
    if (!(sum > 0)) return {};
    for (double& weight : weights) weight /= sum;
    return weights;
}

}  // namespace

bool ViewImportance::serves(const CameraView& camera) const {
    constexpr float kMoved = 0.2f, kTurned = 0.94f;  // 20 degrees
    return glm::distance(glm::vec3(camera.origin), glm::vec3(camera_.origin)) <= kMoved * distance_ &&
           glm::dot(glm::vec3(camera.forward), glm::vec3(camera_.forward)) >= kTurned;
}

/// Draws the shadow maps of importons. `sources` requests which surfel each texel shows.
Result<void> ViewImportance::draw(Frame& frame, Importons& importons, bool sources, ShadowMaps& maps) {
    LUCARNE_ASSIGN(const AtlasLayout layout, importon_layout());
    std::swap(maps.atlas, importons.atlas);
    const auto drawn = draw_shadow_maps(frame.gl.device, *frame.gl.cuts.light, importons.seeds, layout,
                                        sources, frame.times, maps);
    std::swap(maps.atlas, importons.atlas);
    return drawn;
}

Result<void> ViewImportance::look(Frame& frame, const Buffer& materials, uint64_t seed, ShadowMaps& maps) {
    Device& device = frame.gl.device;
    LUCARNE_ASSIGN(const Program* place, device.program("gi/engines/vpl/view_importance/importons.comp"));
    Buffer& lights = first_.seeds.lights;
    LUCARNE_TRY(device.reserve(lights, kImportons * sizeof(VplLight), "importons"));
    materials.bind(kBindMaterials);
    frame.gl.gbuffer.texels.bind(kBindGBuffer);
    lights.bind(kBindLights);
    set(*place, "camera", frame.camera);
    Random random(seed, kPlacing);
    const float x = static_cast<float>(random.uniform()), y = static_cast<float>(random.uniform());
    place->set("cells", kCells);
    place->set_block("shift", std::array{x, y});
    place->dispatch(kImportons);
    return draw(frame, first_, true, maps);
}

Result<void> ViewImportance::look_further(Frame& frame, const Buffer& materials, uint64_t seed,
                                          ShadowMaps& maps) {
    Device& device = frame.gl.device;
    redistribution_.footprint_variance = footprint_variance(0);
    std::swap(maps.atlas, first_.atlas);
    const auto fallen =
        redistribute(device, *frame.gl.cuts.light, maps, materials, false, static_cast<uint32_t>(seed),
                     first_.seeds, redistribution_, second_.seeds);
    std::swap(maps.atlas, first_.atlas);
    LUCARNE_TRY(fallen);
    LUCARNE_TRY(draw(frame, second_, false, maps));
    camera_ = frame.camera;
    first_.seeds.host_lights = first_.seeds.lights.download_all<VplLight>(kImportons);
    second_.seeds.host_lights = second_.seeds.lights.download_all<VplLight>(kImportons);
    distance_ = median_distance(frame.camera, first_.seeds.host_lights);
    return {};
}

Result<std::vector<float>> ViewImportance::openings(Device& device) {
    LUCARNE_ASSIGN(const Program* sum, device.program("gi/engines/vpl/view_importance/openings.comp"));
    LUCARNE_ASSIGN(const AtlasLayout layout, importon_layout());
    LUCARNE_TRY(device.reserve(openings_, kSkyCells * sizeof(uint32_t), "openings to the sky"));
    openings_.clear(0);
    for (const Importons* importons : {&first_, &second_}) {
        importons->seeds.lights.bind(kBindLights);
        importons->atlas.bind(kBindAtlas);
        openings_.bind(kBindOpenings);
        set_layout(*sum, layout);
        sum->set("map_count", layout.maps);
        sum->dispatch(static_cast<uint32_t>(layout.texels()));
    }
    return spread(openings_.download_all<uint32_t>(kSkyCells));
}

Result<void> ViewImportance::measure(Device& device, const Seeds& candidates, uint32_t count) {
    LUCARNE_ASSIGN(const Program* gather, device.program("gi/engines/vpl/view_importance/measure.comp"));
    LUCARNE_ASSIGN(const AtlasLayout layout, importon_layout());
    LUCARNE_TRY(device.reserve(sums_, count * sizeof(float), "importance of VPLs"));
    sums_.clear(0);
    for (const Importons* importons : {&first_, &second_}) {
        importons->seeds.lights.bind_texels(kUnitLights, TexelView::four_words);
        importons->atlas.bind_texels(kUnitAtlas, TexelView::one_word);
        candidates.lights.bind(kBindLights);
        sums_.bind(kBindViewImportance);
        set_layout(*gather, layout);
        gather->set("footprint_variance", footprint_variance(0));
        gather->set("candidate_count", count);
        gather->set("importon_count", layout.maps);
        gather->dispatch(count);
    }
    importance_ = sums_.download_all<float>(count);
    // Neighbours among the importons are about so far apart.
    const float apart = distance_ / kCells;
    nearness_.assign(count, 0);
    for (const Importons* importons : {&first_, &second_})
        add_nearness(candidates.host_lights, importons->seeds.host_lights, apart, nearness_);
    return {};
}

void add_nearness(std::span<const VplLight> candidates, std::span<const VplLight> importons, float apart,
                  std::span<float> sums) {
    for (size_t i = 0; i < candidates.size(); ++i) {
        const glm::vec3 from(candidates[i].position), normal(candidates[i].normal);
        for (const VplLight& importon : importons) {
            if (!(importon.flux.w > 0)) continue;
            const glm::vec3 offset = glm::vec3(importon.position) - from;
            const float height = glm::dot(normal, offset), distance2 = glm::dot(offset, offset);
            if (height > 0) sums[i] += height / std::sqrt(distance2) / (distance2 + apart * apart);
        }
    }
}

std::vector<VplLight> draw_candidates(std::span<const VplLight> candidates, std::span<const float> importance,
                                      std::span<const float> nearness, uint32_t count, uint64_t seed) {
    double light_sum = 0;
    for (const VplLight& candidate : candidates) light_sum += leaving_light(candidate);
    std::vector<VplLight> drawn(count, kDeadLight);
    if (!(light_sum > 0)) return drawn;
    const std::vector<double> by_importance = weighted(candidates, importance),
                              by_nearness = weighted(candidates, nearness);
    const bool important = !by_importance.empty(), near = important && !by_nearness.empty();
    const double alone = important ? kByLightAlone : 1, beside = near ? kByNearness : 0;
    const double offset = Random(seed, candidates.size()).uniform();
    double running = 0;  // expected number of VPLs drawn up to here
    uint32_t next = 0;
    for (size_t i = 0; i < candidates.size() && next < count; ++i) {
        double probability = alone * leaving_light(candidates[i]) / light_sum;
        if (near) probability += beside * by_nearness[i];
        if (important) probability += (1 - alone - beside) * by_importance[i];
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
